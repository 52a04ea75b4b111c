// SPDX-License-Identifier: Apache-2.0
// Skins and morph targets that lie.
#include <limits>

#include "deforming_gltf.hpp"
#include "hostile_gltf.hpp"

namespace lodestar::scene {
namespace {

nlohmann::json& attributesOf(GltfBuilder& b) {
    return b.json["meshes"][0]["primitives"][0]["attributes"];
}

TEST(HostileGltf, theDeformingFileLoads) {
    EXPECT_EQ(outcome(deformingGltf()), "");
}

TEST(HostileGltf, jointsThatTheSkinDoesNotHaveAreRefused) {
    GltfBuilder b = deformingGltf();
    attributesOf(b)["JOINTS_0"] = b.accessor(b.view(Bytes(12, 2)), 5121, "VEC4", 3);
    expectRefusedAt(b, "/meshes/0/primitives/0/attributes/JOINTS_0");
}

TEST(HostileGltf, tooFewJointsOrWeightsAreRefused) {
    for (const char* name : {"JOINTS_0", "WEIGHTS_0"}) {
        GltfBuilder b = deformingGltf();
        b.json["accessors"][attributesOf(b)[name].get<std::size_t>()]["count"] = 2;
        // Whichever of the attributes does not fit the others.
        EXPECT_NE(outcome(b).find("elements where the others have"), std::string::npos) << name;
    }
}

TEST(HostileGltf, weightsThatAreNoNumbersAreRefused) {
    GltfBuilder b = deformingGltf();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    attributesOf(b)["WEIGHTS_0"] = b.floats({1, 0, 0, 0, nan, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    EXPECT_NE(outcome(b).find("is not finite"), std::string::npos);
    // Those that are none, or too large to add up, hold by the first joint or share.
    GltfBuilder c = deformingGltf();
    attributesOf(c)["WEIGHTS_0"] = c.floats({0, 0, 0, 0, -1, 0, 0, 0, 3e38f, 3e38f, 0, 0}, "VEC4");
    EXPECT_EQ(outcome(c), "");
    const Result<Scene> scene = importGltfFromMemory(c.glb(), "hostile.glb");
    for (std::size_t v = 0; v < 3; ++v) {
        float total = 0;
        for (std::size_t k = 0; k < 2; ++k) total += scene->meshes[0].influences[2 * v + k].weight;
        EXPECT_EQ(total, 1);
    }
}

TEST(HostileGltf, inverseBindMatricesAreOneAJoint) {
    GltfBuilder b = deformingGltf();
    b.json["skins"][0]["inverseBindMatrices"] = b.floats(std::vector<float>(16, 1), "MAT4");
    expectRefusedAt(b, "/skins/0/inverseBindMatrices");
}

TEST(HostileGltf, skeletonsHaveNoCycles) {
    GltfBuilder b = deformingGltf();
    b.json["nodes"][2]["children"] = {1};
    EXPECT_NE(outcome(b).find("is part of a cycle of nodes"), std::string::npos);
}

TEST(HostileGltf, aSkinHasNoMoreJointsThanAVertexCanName) {
    GltfBuilder b = deformingGltf();
    b.json["skins"][0].erase("inverseBindMatrices");
    b.json["skins"][0]["joints"] = std::vector<int>(65537, 1);
    expectRefusedAt(b, "/skins/0/joints");
}

TEST(HostileGltf, weightsOfAnAnimationAreOneATargetAndTime) {
    for (const std::size_t count : {std::size_t(3), std::size_t(5), std::size_t(2)}) {
        GltfBuilder b = deformingGltf();
        b.json["animations"][0]["samplers"][1]["output"] =
            b.floats(std::vector<float>(count, 1), "SCALAR");
        expectRefusedAt(b, "/animations/0/samplers/1/output");
    }
    GltfBuilder b = deformingGltf();
    b.json["animations"][0]["samplers"][1]["output"] = b.floats({0, 0, 0, 0, 0, 0}, "VEC3");
    expectRefusedAt(b, "/animations/0/samplers/1/output");
    // A node that has no targets: the channel is left out.
    b = deformingGltf();
    b.json["animations"][0]["channels"][1]["target"]["node"] = 1;
    EXPECT_EQ(outcome(b), "");
}

TEST(HostileGltf, manyInstancesOfAMeshThatDeformsAreCharged) {
    GltfBuilder b = deformingGltf();
    b.json["nodes"][0].erase("skin");
    const std::size_t many = 2000, vertices = 30000;
    attributesOf(b) = {{"POSITION", b.floats(std::vector<float>(3 * vertices, 1), "VEC3")}};
    b.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", attributesOf(b)["POSITION"]}},
                                                       {{"POSITION", attributesOf(b)["POSITION"]}}};
    const std::size_t places = b.floats(std::vector<float>(3 * many, 1), "VEC3");
    b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", places}};
    expectRefusedAt(b, "/nodes/0");
}

TEST(HostileGltf, everyTruncationAndBitFlipOfADeformingFileEndsInOneLine) {
    const Bytes file = deformingGltf().glb();
    for (std::size_t length = 0; length < file.size(); ++length)
        EXPECT_NE(outcome(Bytes(file.begin(), file.begin() + std::ptrdiff_t(length))), "");
    for (std::size_t i = 0; i < file.size(); ++i) {
        Bytes flipped = file;
        flipped[i] ^= std::uint8_t(1u << i % 8);
        outcome(flipped);
    }
}

}  // namespace
}  // namespace lodestar::scene

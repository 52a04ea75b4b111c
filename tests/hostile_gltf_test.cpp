// SPDX-License-Identifier: Apache-2.0
// Files that lie: each loads or is refused with one line, and nothing else happens. Worth most
// under the asan preset.
#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include <lodestar/scene/import.hpp>

#include "hostile_gltf.hpp"
#include "scenes.hpp"

namespace lodestar::scene {
namespace {

/// A file with a bit of everything: mesh, indices, sparse, material, image, skin, animation.
GltfBuilder everything() {
    GltfBuilder b;
    const std::size_t position = b.floats(kTriangle, "VEC3");
    const std::size_t normal = b.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    const std::size_t joints = b.accessor(b.view(Bytes(12, 0)), 5121, "VEC4", 3);
    const std::size_t weights = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
    nlohmann::json& primitive = b.show(
        {{"POSITION", position}, {"NORMAL", normal}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}});
    primitive["indices"] = b.shorts({0, 1, 2});
    primitive["material"] = 0;
    const std::size_t delta = b.floats(std::vector<float>(9, 0.5f), "VEC3");
    b.json["accessors"][delta]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.view(Bytes{2})}, {"componentType", 5121}}},
        {"values", {{"bufferView", b.view(std::vector<float>{1, 2, 3})}}}};
    b.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", delta}}};
    b.json["meshes"][0]["weights"] = {0.5};
    b.json["nodes"][0]["skin"] = 0;
    b.add("nodes", {{"children", {2}}, {"rotation", {0, 0, 0, 1}}});
    b.add("nodes", {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.json["scenes"] = {{{"nodes", {0, 1}}}};
    b.json["scene"] = 0;
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    b.add("skins", {{"joints", {1}}});
    b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}});
    b.add("materials", {{"normalTexture", {{"index", 0}}}});
    b.add("textures", {{"source", 0}, {"sampler", 0}});
    b.add("samplers", {{"wrapS", 33071}});
    // A 1×1 grey PNG.
    const Bytes png = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
                       0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01,
                       0x08, 0x00, 0x00, 0x00, 0x00, 0x3a, 0x7e, 0x9b, 0x55, 0x00, 0x00, 0x00,
                       0x0a, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9c, 0x63, 0x68, 0x00, 0x00, 0x00,
                       0x82, 0x00, 0x81, 0x77, 0xcd, 0x72, 0xb6, 0x00, 0x00, 0x00, 0x00, 0x49,
                       0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    b.add("images", {{"bufferView", b.view(png)}, {"mimeType", "image/png"}});
    const std::size_t times = b.floats({0, 1}, "SCALAR");
    const std::size_t moves = b.floats({0, 0, 0, 1, 0, 0}, "VEC3");
    b.add("animations",
          {{"samplers", {{{"input", times}, {"output", moves}}}},
           {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}});
    return b;
}

TEST(HostileGltf, theSeedOfTheseTestsLoads) {
    const Result<Scene> scene = importGltfFromMemory(everything().glb(), "hostile.glb");
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(countTriangles(*scene).drawn, 1u);
    EXPECT_EQ(scene->images.size(), 1u);
    EXPECT_EQ(scene->animations.size(), 1u);
    EXPECT_EQ(scene->cameras.size(), 1u);
    EXPECT_EQ(scene->lights.size(), 1u);
    EXPECT_EQ(scene->meshes[0].targets[0].position[2], glm::vec3(1, 2, 3));
}

// --- the validator's files ---------------------------------------------------------------------

struct Verdict {
    std::string file;
    int errors = 0;
    std::string codes;
};

std::vector<Verdict> verdicts() {
    std::ifstream table(scenesFolder() / "malformed" / "EXPECTED.tsv");
    std::vector<Verdict> all;
    std::string line;
    std::getline(table, line);
    while (std::getline(table, line)) {
        std::istringstream fields(line);
        std::string errors;
        Verdict verdict;
        std::getline(fields, verdict.file, '\t');
        std::getline(fields, errors, '\t');
        std::getline(fields, verdict.codes);
        verdict.errors = std::stoi(errors);
        all.push_back(verdict);
    }
    return all;
}

TEST(HostileGltf, untrueIndexSizeOffsetOrHierarchyIsRefused) {
    REQUIRE_SCENES();
    constexpr const char* kUntrue[] = {"UNRESOLVED_REFERENCE",
                                       "ACCESSOR_TOO_LONG",
                                       "ACCESSOR_SMALL_BYTESTRIDE",
                                       "ACCESSOR_SPARSE_COUNT",
                                       "ACCESSOR_INDEX_",
                                       "ACCESSOR_INVALID_FLOAT",
                                       "JOINTS_INDEX_OOB",
                                       "INVALID_COUNT",
                                       "INVALID_FORMAT",
                                       "BYTE_LENGTH_MISMATCH",
                                       "GLB_",
                                       "BUFFER_MISSING",
                                       "UNEQUAL_ACCESSOR_COUNT",
                                       "WEIGHTS_COUNT",
                                       "NODE_LOOP",
                                       "NODE_PARENT_OVERRIDE",
                                       "SKIN_NO_COMMON_ROOT",
                                       "SKIN_SKELETON_INVALID",
                                       "INVALID_URI",
                                       "UNUSED_EXTENSION_REQUIRED"};
    const std::vector<Verdict> all = verdicts();
    EXPECT_EQ(all.size(), 237u);
    std::size_t refused = 0;
    for (const Verdict& verdict : all) {
        const std::filesystem::path path = scenesFolder() / "malformed" / verdict.file;
        const std::string message = outcome(importGltf(path), path.filename().string());
        const bool untrue = std::any_of(
            std::begin(kUntrue), std::end(kUntrue),
            [&](const char* code) { return verdict.codes.find(code) != std::string::npos; });
        EXPECT_FALSE(untrue && message.empty())
            << verdict.file << " (" << verdict.codes << ") loaded";
        refused += !message.empty();
    }
    EXPECT_GT(refused, 80u);
}

TEST(HostileGltf, validFilesLoad) {
    REQUIRE_SCENES();
    // Valid by themselves, but with buffers that a host program would have to supply, or for a
    // later version of glTF.
    const std::set<std::string> incomplete = {"named_objects.gltf", "unused_objects.gltf",
                                              "min_version_valid.gltf"};
    for (const Verdict& verdict : verdicts()) {
        const std::filesystem::path path = scenesFolder() / "malformed" / verdict.file;
        if (verdict.errors != 0 || incomplete.contains(path.filename().string())) continue;
        EXPECT_EQ(outcome(importGltf(path), path.filename().string()), "") << verdict.file;
    }
}

// --- damage ------------------------------------------------------------------------------------

TEST(HostileGltf, everyTruncationIsRefused) {
    const Bytes file = everything().glb();
    for (std::size_t length = 0; length < file.size(); ++length)
        EXPECT_NE(outcome(Bytes(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length))),
                  "")
            << length;
}

TEST(HostileGltf, everyFlippedBitLoadsOrIsRefused) {
    const Bytes file = everything().glb();
    std::size_t refused = 0;
    for (std::size_t bit = 0; bit < 8 * file.size(); bit += 1 + bit % 3) {
        Bytes damaged = file;
        damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
        refused += !outcome(damaged).empty();
    }
    EXPECT_GT(refused, file.size());  // most bits are JSON
}

TEST(HostileGltf, everyNumberMadeAbsurdLoadsOrIsRefused) {
    const GltfBuilder good = everything();
    const nlohmann::json flat = good.json.flatten();
    for (const auto& [path, value] : flat.items()) {
        for (const nlohmann::json& absurd :
             {nlohmann::json(4294967295u), nlohmann::json(18446744073709551615ull),
              nlohmann::json(-1), nlohmann::json(1e38), nlohmann::json(0.5), nlohmann::json(),
              nlohmann::json("text"), nlohmann::json::array(), nlohmann::json::object()}) {
            GltfBuilder bad = good;
            bad.json[nlohmann::json::json_pointer(path)] = absurd;
            outcome(bad);
        }
    }
}

// --- lies --------------------------------------------------------------------------------------

TEST(HostileGltf, absurdCountsAllocateNothing) {
    for (const std::uint64_t count :
         {4294967295ull, 9007199254740992ull, 18446744073709551615ull}) {
        GltfBuilder builder;
        builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
        builder.json["accessors"][0]["count"] = count;
        expectRefusedAt(builder, "/accessors/0/count");
        builder.json["accessors"][0].erase("bufferView");
        expectRefusedAt(builder, "/accessors/0/count");
    }
}

TEST(HostileGltf, offsetsThatWrapAroundAreRefused) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.json["accessors"][0]["byteOffset"] = 18446744073709551615ull;
    expectRefusedAt(builder, "/accessors/0/byteOffset");
    builder.json["accessors"][0]["byteOffset"] = 4;
    expectRefusedAt(builder, "/accessors/0");
    builder.json["accessors"][0].erase("byteOffset");
    builder.json["bufferViews"][0]["byteLength"] = 4294967295u;
    expectRefusedAt(builder, "/bufferViews/0");
}

TEST(HostileGltf, indexOutOfRangeIsRefused) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}})["indices"] =
        builder.shorts({0, 1, 3});
    EXPECT_EQ(outcome(builder),
              "hostile.glb: /meshes/0/primitives/0/indices: index 3 is not below the number of "
              "vertices (3); export it again");
}

TEST(HostileGltf, sparseIndexOutOfRangeIsRefused) {
    GltfBuilder builder = everything();
    builder.bin[builder.json["bufferViews"][6]["byteOffset"].get<std::size_t>()] = 3;
    expectRefusedAt(builder, "/accessors/5/sparse/indices");
}

TEST(HostileGltf, positionsThatAreNotFiniteAreRefused) {
    for (const float bad :
         {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
        GltfBuilder builder;
        std::vector<float> positions = kTriangle;
        positions[4] = bad;
        builder.show({{"POSITION", builder.floats(positions, "VEC3")}});
        EXPECT_EQ(outcome(builder),
                  "hostile.glb: /accessors/0: element 1 is not finite; export it again");
    }
}

TEST(HostileGltf, transformsThatOverflowAreRefused) {
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.json["nodes"][0]["scale"] = {1e30, 1, 1};
    builder.add("nodes", {{"children", {0}}, {"scale", {1e30, 1, 1}}});
    expectRefusedAt(builder, "/nodes/0");
    builder.json["nodes"][1]["scale"] = {1, 1, 1};
    expectRefusedAt(builder, "/nodes");
}

TEST(HostileGltf, cyclesAndSecondParentsAreRefused) {
    GltfBuilder builder;
    for (const int child : {1, 2, 0}) builder.add("nodes", {{"children", {child}}});
    expectRefusedAt(builder, "/nodes/0");
    builder.json["nodes"] = {{{"children", {0}}}};
    expectRefusedAt(builder, "/nodes/0");
    builder.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, nlohmann::json::object()};
    expectRefusedAt(builder, "/nodes/1/children/0");
    builder.json["nodes"] = {{{"children", {1}}}, nlohmann::json::object()};
    builder.json["scenes"] = {{{"nodes", {1}}}};
    expectRefusedAt(builder, "/scenes/0/nodes/0");
}

TEST(HostileGltf, chainOfAHundredThousandNodesLoads) {
    constexpr int kNodes = 100000;
    GltfBuilder builder;
    builder.show({{"POSITION", builder.floats(kTriangle, "VEC3")}});
    builder.json["nodes"] = nlohmann::json::array();
    for (int i = 0; i + 1 < kNodes; ++i)
        builder.json["nodes"].push_back({{"children", {i + 1}}, {"translation", {1, 0, 0}}});
    builder.json["nodes"].push_back({{"mesh", 0}});
    const Result<Scene> scene = importGltfFromMemory(builder.glb(), "hostile.glb");
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(worldFromNode(*scene)[scene->instances.at(0).node][3].x, kNodes - 1);
}

TEST(HostileGltf, deepJsonIsRefused) {
    const std::string deep(200000, '[');
    EXPECT_NE(outcome(R"({"asset":{"version":"2.0"},"extras":)" + deep), "");
    EXPECT_NE(outcome(deep).find("nested"), std::string::npos);
}

TEST(HostileGltf, repetitionEndsAtABudget) {
    // Few bytes ask for much: 3000 meshes of the same 3000 triangles, and so on.
    const auto timed = [](const GltfBuilder& builder) {
        const auto start = std::chrono::steady_clock::now();
        const std::string message = outcome(builder);
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
        return message;
    };
    GltfBuilder primitives;
    const std::size_t position = primitives.floats(std::vector<float>(9000, 1.0f), "VEC3");
    primitives.show({{"POSITION", position}});
    for (int i = 0; i < 30000; ++i)
        primitives.json["meshes"][0]["primitives"].push_back(
            {{"attributes", {{"POSITION", position}}}});
    EXPECT_NE(timed(primitives).find("far more than the file's size"), std::string::npos);

    GltfBuilder instances;
    instances.show({{"POSITION", instances.floats(kTriangle, "VEC3")}});
    const std::size_t places = instances.floats(std::vector<float>(30000, 1.0f), "VEC3");
    for (int i = 0; i < 5000; ++i)
        instances.add(
            "nodes",
            {{"mesh", 0},
             {"extensions",
              {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
    EXPECT_NE(timed(instances).find("far more than the file's size"), std::string::npos);

    GltfBuilder materials;
    materials.json["materials"] =
        nlohmann::json(std::vector<nlohmann::json>(300000, nlohmann::json::object()));
    EXPECT_NE(timed(materials).find("far more than the file's size"), std::string::npos);

    GltfBuilder accessors;
    const std::size_t view = accessors.view(std::vector<float>(250000, 1.0f));
    for (int i = 0; i < 20000; ++i) accessors.accessor(view, 5126, "SCALAR", 250000);
    EXPECT_NE(timed(accessors).find("far more than the file's size"), std::string::npos);
}

}  // namespace
}  // namespace lodestar::scene

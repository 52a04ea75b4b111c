// SPDX-License-Identifier: Apache-2.0
// Skins and morph targets that an animation moves.
#include <lodestar/scene/deform_reference.hpp>

#include "deforming_gltf.hpp"
#include "gltf_import.hpp"

namespace lodestar::scene {
namespace {

TEST(ImportGltf, jointsAndWeightsMoveTheVertices) {
    const Scene scene = built(deformingGltf());
    ASSERT_EQ(scene.instances.size(), 1u);
    const Instance& instance = scene.instances[0];
    EXPECT_TRUE(deforms(scene, instance));
    EXPECT_EQ(scene.notes.size(), 0u);
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.jointsPerVertex, 2u);
    EXPECT_EQ(mesh.influences[2].weight, 1);  // 3 in the file
    EXPECT_EQ(mesh.influences[4].weight, 0.5f);
    EXPECT_EQ(mesh.influences[5].weight, 0.5f);
    EXPECT_EQ(mesh.influences[5].joint, 1u);
    EXPECT_EQ(scene.animations.at(0).duration, 1);

    // Half-way: joints at (10, 0, 0) and (10, 6, 0), weights (0.5, −0.25).
    const Pose pose = poseAt(scene, 0.5f);
    const auto moved = deformReference(scene, instance, pose);
    EXPECT_NEAR(glm::distance(moved[0].position, glm::dvec3(9, 0, 0.5)), 0, 1e-6);
    EXPECT_NEAR(glm::distance(moved[1].position, glm::dvec3(11, 6, 0.5)), 0, 1e-6);
    // (1, 0.5, 0.5) by both halves: (10, 0.5, 0.5) and (11, 6.5, 0.5).
    EXPECT_NEAR(glm::distance(moved[2].position, glm::dvec3(10.5, 3.5, 0.5)), 0, 1e-6);
    const Bounds box = worldBounds(scene, pose);
    for (const DeformedVertex& v : moved)
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(v.position[axis], box.lower[axis]);
            EXPECT_LE(v.position[axis], box.upper[axis]);
        }
}

TEST(ImportGltf, missingNormalsOfWhatDeformsAreFlatAndTurnWithTheTargets) {
    GltfBuilder builder = deformingGltf();
    builder.json["meshes"][0]["primitives"][0]["indices"] = builder.shorts({0, 1, 2, 0, 2, 1});
    const Scene scene = built(builder);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.vertices.size(), 6u);
    ASSERT_EQ(mesh.influences.size(), 12u);
    EXPECT_EQ(mesh.vertices[0].normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.vertices[3].normal, glm::vec3(0, 0, -1));
    EXPECT_EQ(mesh.influences[2 * 5].joint, 1u);  // the last corner is vertex 1
    EXPECT_EQ(mesh.targets[1].position[4], glm::vec3(0, 2, 0));
    // A target that moves the whole triangle does not turn it.
    EXPECT_EQ(mesh.targets[0].normal[0], glm::vec3(0));
    expectSound(scene);
}

TEST(ImportGltf, jointsOutsideOfTheSceneStillHoldTheMesh) {
    GltfBuilder builder = deformingGltf();
    const Scene whole = built(builder);
    builder.json["scenes"] = {{{"nodes", {0}}}};
    const Scene scene = built(builder);
    ASSERT_EQ(scene.instances.size(), 1u);
    const auto expected = deformReference(whole, whole.instances[0], poseAt(whole, 0.3f));
    const auto moved = deformReference(scene, scene.instances[0], poseAt(scene, 0.3f));
    for (std::size_t i = 0; i < moved.size(); ++i)
        EXPECT_EQ(moved[i].position, expected.at(i).position);
}

TEST(ImportGltf, whatNothingMovesIsBakedAtRest) {
    GltfBuilder builder = deformingGltf();
    builder.json["animations"][0]["channels"][0]["target"]["node"] = 0;  // moves no joint
    builder.json["animations"][0]["channels"].erase(1);
    const Scene scene = built(builder);
    EXPECT_FALSE(deforms(scene, scene.instances[0]));
    EXPECT_EQ(scene.meshes[0].vertices[1].position, glm::vec3(11, 5, 0));
    EXPECT_EQ(scene.notes.size(), 0u);
}

TEST(ImportGltf, meshesOfOneSkinShareTheirData) {
    GltfBuilder builder = deformingGltf();
    builder.add("nodes", {{"mesh", 0}, {"skin", 0}, {"weights", {1, 1}}});
    const Scene scene = built(builder);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.skins.size(), 1u);
    const Pose pose = poseAt(scene, 0);
    EXPECT_EQ(deformReference(scene, scene.instances[0], pose)[0].position.z, 0);
    EXPECT_EQ(deformReference(scene, scene.instances[1], pose)[0].position.z, 1);
}

}  // namespace
}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/scene.hpp>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <lodestar/scene/import.hpp>

namespace lodestar::scene {
namespace {

std::string refusal(const std::string& source) {
    const Result<Scene> scene = load(source);
    EXPECT_FALSE(scene) << source;
    return scene ? "" : scene.error().message;
}

TEST(Scene, boundsGrowByPointsAndBoxes) {
    Bounds bounds;
    EXPECT_TRUE(bounds.empty());
    EXPECT_EQ(bounds.radius(), 0);
    bounds.add(glm::vec3(1, 2, 3));
    EXPECT_FALSE(bounds.empty());
    bounds.add(Bounds{});  // an empty box adds nothing
    EXPECT_EQ(bounds.lower, bounds.upper);
    bounds.add(Bounds{{-1, 0, 0}, {0, 1, 1}});
    EXPECT_EQ(bounds.lower, glm::vec3(-1, 0, 0));
    EXPECT_EQ(bounds.upper, glm::vec3(1, 2, 3));
    EXPECT_FLOAT_EQ(bounds.radius(), 0.5f * std::sqrt(4.0f + 4 + 9));
}

TEST(Scene, transformedBoundsAreThoseOfTheCorners) {
    const Bounds box{{-1, 2, 0}, {3, 5, 1}};
    glm::mat4 transform = glm::translate(glm::mat4(1), glm::vec3(7, -1, 2));
    transform = glm::rotate(transform, 0.7f, glm::normalize(glm::vec3(1, 2, 3)));
    transform = glm::scale(transform, glm::vec3(2, -1, 0.5f));
    Bounds expected;
    for (int corner = 0; corner < 8; ++corner)
        expected.add(glm::vec3(
            transform * glm::vec4(corner & 1 ? 3 : -1, corner & 2 ? 5 : 2, corner & 4 ? 1 : 0, 1)));
    const Bounds actual = box.transformed(transform);
    EXPECT_LT(glm::distance(actual.lower, expected.lower), 1e-5f);
    EXPECT_LT(glm::distance(actual.upper, expected.upper), 1e-5f);
    EXPECT_TRUE(Bounds{}.transformed(transform).empty());
}

TEST(Scene, worldBoundsAndCountsGoOverInstances) {
    Scene scene;
    scene.meshes.resize(2);
    scene.meshes[0].indices.resize(6);
    scene.meshes[0].bounds = {glm::vec3(0), glm::vec3(1)};
    scene.meshes[1].indices.resize(3);  // stored, but no instance shows it
    scene.meshes[1].bounds = {glm::vec3(-99), glm::vec3(99)};
    scene.nodes.resize(2);
    scene.instances = {{0, 0}, {0, 1}, {0, 1}};
    scene.instances[2].nodeFromObject = glm::translate(glm::mat4(1), glm::vec3(0, 0, -3));
    const std::vector<glm::mat4> world = {glm::mat4(1),
                                          glm::translate(glm::mat4(1), glm::vec3(10, 0, 0))};
    const Bounds bounds = worldBounds(scene, world);
    EXPECT_EQ(bounds.lower, glm::vec3(0, 0, -3));
    EXPECT_EQ(bounds.upper, glm::vec3(11, 1, 1));
    EXPECT_EQ(countTriangles(scene).stored, 3u);
    EXPECT_EQ(countTriangles(scene).drawn, 6u);
}

TEST(Load, builtinPrefixNamesAProceduralScene) {
    const Result<Scene> scene = load("builtin:grid:50");
    ASSERT_TRUE(scene);
    EXPECT_EQ(countTriangles(*scene).drawn, 50u);
    EXPECT_NE(refusal("builtin:").find("builtin:columns"), std::string::npos);
}

TEST(Load, missingFileIsSaidPlainly) {
    for (const char* name : {"not/there.glb", "nor there.obj", ""})
        EXPECT_EQ(refusal(name), std::string(name) + ": no such file");
}

TEST(Load, folderIsRefused) {
    const std::string folder = std::filesystem::temp_directory_path().string();
    EXPECT_EQ(refusal(folder).find(folder + ": is a folder"), 0u);
}

TEST(Load, unknownExtensionIsRefusedWithWhatToDo) {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / "lodestar_scene_test.unknown";
    std::ofstream(path) << "1 2 3";
    const std::string message = refusal(path.string());
    EXPECT_EQ(message.find(path.string() + ": .unknown is not a format"), 0u);
    EXPECT_NE(message.find("convert it to glTF"), std::string::npos);
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace lodestar::scene

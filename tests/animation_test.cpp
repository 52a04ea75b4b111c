// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <lodestar/scene/import.hpp>
#include <lodestar/scene/scene.hpp>

#include "scenes.hpp"

namespace lodestar::scene {
namespace {

Scene animated(AnimationPath path, Interpolation interpolation, std::vector<float> times,
               std::vector<glm::vec4> values) {
    Scene scene;
    scene.nodes.resize(1);
    Animation animation;
    animation.duration = times.back();
    animation.channels.push_back({0, path, interpolation, std::move(times), std::move(values)});
    scene.animations.push_back(animation);
    return scene;
}

float xAt(const Scene& scene, float seconds) {
    return worldFromNode(scene, seconds)[0][3].x;
}

/// The angle about z that the first node is turned by.
float turnAt(const Scene& scene, float seconds) {
    const glm::mat4 m = worldFromNode(scene, seconds)[0];
    return std::atan2(m[0].y, m[0].x);
}

glm::vec4 aboutZ(float angle) {
    return {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
}

TEST(Animation, sceneWithoutAnimationIsAtRest) {
    Scene scene;
    scene.nodes.resize(2);
    scene.nodes[0].translation = {1, 2, 3};
    scene.nodes[0].scale = glm::vec3(2);
    scene.nodes[1].parent = 0;
    scene.nodes[1].translation = {1, 0, 0};
    const std::vector<glm::mat4> world = worldFromNode(scene, 7);
    EXPECT_EQ(world[0][3], glm::vec4(1, 2, 3, 1));
    EXPECT_EQ(world[1][3], glm::vec4(3, 2, 3, 1));
}

TEST(Animation, matrixTakesThePlaceOfTheParts) {
    Scene scene;
    scene.nodes.resize(1);
    scene.nodes[0].hasMatrix = true;
    scene.nodes[0].matrix[3] = {4, 5, 6, 1};
    scene.nodes[0].translation = {1, 1, 1};
    EXPECT_EQ(worldFromNode(scene)[0][3], glm::vec4(4, 5, 6, 1));
}

TEST(Animation, rotationIsAppliedBetweenScaleAndTranslation) {
    Scene scene;
    scene.nodes.resize(1);
    scene.nodes[0].translation = {10, 0, 0};
    scene.nodes[0].rotation = glm::quat(std::sqrt(0.5f), 0, 0, std::sqrt(0.5f));  // 90° about z
    scene.nodes[0].scale = {2, 1, 1};
    const glm::vec4 point = worldFromNode(scene)[0] * glm::vec4(1, 0, 0, 1);
    EXPECT_NEAR(point.x, 10, 1e-5);
    EXPECT_NEAR(point.y, 2, 1e-5);
}

TEST(Animation, linearIsHalfWayBetweenKeys) {
    const Scene scene = animated(AnimationPath::translation, Interpolation::linear, {0, 2},
                                 {{0, 0, 0, 0}, {4, 0, 0, 0}});
    EXPECT_FLOAT_EQ(xAt(scene, 1), 2);
    EXPECT_FLOAT_EQ(xAt(scene, 0.5f), 1);
}

TEST(Animation, stepHoldsTheEarlierKey) {
    const Scene scene = animated(AnimationPath::translation, Interpolation::step, {0, 1, 2},
                                 {{1, 0, 0, 0}, {2, 0, 0, 0}, {3, 0, 0, 0}});
    EXPECT_EQ(xAt(scene, 0.99f), 1);
    EXPECT_EQ(xAt(scene, 1), 2);
    EXPECT_EQ(xAt(scene, 1.99f), 2);
}

TEST(Animation, loopsOverItsDuration) {
    const Scene scene = animated(AnimationPath::translation, Interpolation::linear, {0, 2},
                                 {{0, 0, 0, 0}, {4, 0, 0, 0}});
    EXPECT_FLOAT_EQ(xAt(scene, 5), 2);
    EXPECT_FLOAT_EQ(xAt(scene, -0.5f), 3);
}

TEST(Animation, firstKeyHoldsBeforeItsTime) {
    const Scene scene = animated(AnimationPath::translation, Interpolation::linear, {1, 2},
                                 {{3, 0, 0, 0}, {4, 0, 0, 0}});
    EXPECT_EQ(xAt(scene, 0.2f), 3);
}

TEST(Animation, rotationTakesTheShortWayAtEvenSpeed) {
    // The second key is the same rotation with the opposite sign.
    const Scene scene = animated(AnimationPath::rotation, Interpolation::linear, {0, 1},
                                 {aboutZ(0), -aboutZ(1.2f)});
    EXPECT_NEAR(turnAt(scene, 0.25f), 0.3f, 1e-4f);
    EXPECT_NEAR(turnAt(scene, 0.5f), 0.6f, 1e-4f);
}

TEST(Animation, cubicSplineFollowsItsTangents) {
    // x = t³ over two seconds: the tangents are 3t².
    const Scene scene = animated(
        AnimationPath::translation, Interpolation::cubicSpline, {0, 2},
        {{9, 9, 9, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {12, 0, 0, 0}, {8, 0, 0, 0}, {9, 9, 9, 0}});
    for (const float t : {0.0f, 0.5f, 1.0f, 1.5f})
        EXPECT_NEAR(xAt(scene, t), t * t * t, 1e-4f) << t;
}

TEST(Animation, cubicSplineRotationsAreNormalised) {
    const Scene scene =
        animated(AnimationPath::rotation, Interpolation::cubicSpline, {0, 1},
                 {glm::vec4(0), aboutZ(0), glm::vec4(0), glm::vec4(0), aboutZ(2.0f), glm::vec4(0)});
    EXPECT_NEAR(glm::length(worldFromNode(scene, 0.5f)[0][0]), 1, 1e-5);
    EXPECT_NEAR(turnAt(scene, 0.5f), 1.0f, 1e-4f);
}

TEST(Animation, scaleChannelScales) {
    const Scene scene =
        animated(AnimationPath::scale, Interpolation::linear, {0, 1}, {{1, 1, 1, 0}, {3, 1, 1, 0}});
    EXPECT_FLOAT_EQ(worldFromNode(scene, 0.5f)[0][0].x, 2);
}

TEST(Animation, childrenMoveWithTheirParent) {
    Scene scene = animated(AnimationPath::translation, Interpolation::linear, {0, 1},
                           {{0, 0, 0, 0}, {2, 0, 0, 0}});
    scene.nodes.resize(2);
    scene.nodes[1].parent = 0;
    scene.nodes[1].translation = {0, 1, 0};
    EXPECT_EQ(worldFromNode(scene, 0.5f)[1][3], glm::vec4(1, 1, 0, 1));
}

TEST(Animation, interpolationTestHasEveryKind) {
    REQUIRE_SCENES();
    const Result<Scene> scene = importGltf(scenesFolder() / "tests" / "InterpolationTest.glb");
    ASSERT_TRUE(scene) << scene.error().message;
    ASSERT_EQ(scene->animations.size(), 9u);
    int seen[3][3] = {};
    for (const Animation& animation : scene->animations)
        for (const AnimationChannel& channel : animation.channels) {
            ++seen[static_cast<int>(channel.path)][static_cast<int>(channel.interpolation)];
            const std::size_t perTime = channel.interpolation == Interpolation::cubicSpline ? 3 : 1;
            EXPECT_EQ(channel.values.size(), perTime * channel.times.size());
        }
    for (const auto& path : seen)
        for (const int count : path) EXPECT_EQ(count, 1);
}

TEST(Animation, littlestTokyoMoves) {
    REQUIRE_SCENES();
    const Result<Scene> scene = importGltf(scenesFolder() / "littlest_tokyo.glb");
    ASSERT_TRUE(scene) << scene.error().message;
    ASSERT_EQ(scene->animations.size(), 1u);
    EXPECT_GT(scene->animations[0].duration, 1);
    const std::vector<glm::mat4> start = worldFromNode(*scene, 0), later = worldFromNode(*scene, 1);
    EXPECT_NE(start, later);
    EXPECT_EQ(start, worldFromNode(*scene, scene->animations[0].duration));
}

}  // namespace
}  // namespace lodestar::scene

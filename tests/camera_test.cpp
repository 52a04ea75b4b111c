// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/camera.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

namespace lodestar::scene {
namespace {

glm::vec3 ndc(const Camera& camera, float aspect, glm::vec3 point) {
    const glm::vec4 clip =
        camera.clipFromView(aspect) * camera.viewFromWorld() * glm::vec4(point, 1);
    return glm::vec3(clip) / clip.w;
}

void expectNear(glm::vec3 a, glm::vec3 b, float tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Camera, depthIsOneAtTheNearPlaneAndZeroAtInfinity) {
    Camera camera;
    camera.nearPlane = 0.25f;
    const glm::mat4 clip = camera.clipFromView(1.5f);
    for (const float distance : {0.25f, 0.5f, 3.0f, 1e6f}) {
        const glm::vec4 p = clip * glm::vec4(0, 0, -distance, 1);
        EXPECT_FLOAT_EQ(p.z / p.w, 0.25f / distance);
        EXPECT_FLOAT_EQ(p.w, distance);
    }
    const glm::vec4 farthest = clip * glm::vec4(0, 0, -1, 0);
    EXPECT_EQ(farthest.z / farthest.w, 0.0f);
}

TEST(Camera, upIsTowardsTheTopRowAndTheFovIsVertical) {
    Camera camera;
    camera.eye = {0, 0, 5};
    camera.verticalFov = 1.2f;
    const float edge = std::tan(0.6f) * 5;  // half the height of the view at distance 5
    expectNear(ndc(camera, 2, {0, edge, 0}), {0, -1, 0.002f}, 1e-5f);
    expectNear(ndc(camera, 2, {2 * edge, -edge, 0}), {1, 1, 0.002f}, 1e-5f);
}

TEST(Camera, viewLooksAlongMinusZEvenStraightDown) {
    Camera camera;
    camera.eye = {2, 7, -3};
    camera.at = {2, 0, -3};
    const glm::vec4 seen = camera.viewFromWorld() * glm::vec4(camera.at, 1);
    expectNear(seen, {0, 0, -7}, 1e-5f);
    camera.at = camera.eye;  // no direction at all: any view will do, but a finite one
    EXPECT_TRUE(std::isfinite(camera.viewFromWorld()[0][0]));
}

TEST(Camera, frameHoldsTheWholeBoxTightlyAtAnyAspect) {
    const Bounds boxes[] = {{{-1, -1, -1}, {1, 1, 1}},
                            {{-300, 0, -2}, {500, 1, 4}},
                            {{0.001f, 0.002f, 0}, {0.002f, 0.009f, 0.001f}},
                            {{-1, -1, -50}, {1, 1, 80}},
                            {{0, 0, -50}, {0, 0, 80}},
                            {{9999, 5, 5}, {10001, 5, 6}}};
    for (const Bounds& box : boxes)
        for (const float aspect : {0.2f, 0.75f, 1.0f, 16.0f / 9, 5.0f}) {
            const Camera camera = frame(box, aspect);
            float widest = 0;
            for (int corner = 0; corner < 8; ++corner) {
                const glm::vec3 p(corner & 1 ? box.upper.x : box.lower.x,
                                  corner & 2 ? box.upper.y : box.lower.y,
                                  corner & 4 ? box.upper.z : box.lower.z);
                const glm::vec3 seen = ndc(camera, aspect, p);
                EXPECT_GT(seen.z, 0);  // in front of the eye
                EXPECT_LT(seen.z, 1);  // and beyond the near plane
                widest = std::max({widest, std::abs(seen.x), std::abs(seen.y)});
            }
            EXPECT_LT(widest, 0.98f);
            // A line away from the eye may be small in the picture; anything else fills it.
            EXPECT_GT(widest, box.upper.x == box.lower.x ? 0.0f : 0.90f);
        }
}

TEST(Camera, frameLooksFromTheFrontAboveAndRight) {
    const Camera camera = frame({{-1, -1, -1}, {1, 1, 1}}, 1);
    const glm::vec3 direction = glm::normalize(camera.eye - camera.at);
    EXPECT_GT(direction.x, 0.1f);
    EXPECT_GT(direction.y, 0.1f);
    EXPECT_GT(direction.z, direction.x);
}

TEST(Camera, framedNearPlaneFollowsTheSizeOfTheScene) {
    const Camera small = frame({{-1, -1, -1}, {1, 1, 1}}, 1);
    const Camera large = frame({{-50, -50, -50}, {50, 50, 50}}, 1);
    EXPECT_NEAR(large.nearPlane / small.nearPlane, 50, 1e-3);
    EXPECT_GT(frame({{5, 5, 5}, {5, 5, 5}}, 1).nearPlane, 0);
}

TEST(Camera, frameOfNothingIsASaneView) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    for (const Bounds& nothing : {Bounds{}, Bounds{glm::vec3(kNan), glm::vec3(1)}}) {
        const Camera camera = frame(nothing, 1.5f);
        EXPECT_NEAR(glm::distance(camera.eye, camera.at), 5.5f, 2.5f);
        EXPECT_EQ(camera.at, glm::vec3(0));
        EXPECT_GT(camera.nearPlane, 0);
    }
}

TEST(Camera, orbitTurnsCounterClockwiseSeenFromAbove) {
    Camera camera;
    camera.eye = {1, 2, 4};  // in front of the pivot
    camera.at = {1, 0, 1};
    const Camera turned = orbited(camera, {1, 0, 1}, 1.5707963f);
    expectNear(turned.eye, {4, 2, 1}, 1e-5f);  // to its right
    expectNear(turned.at, {1, 0, 1}, 1e-5f);
    Camera back = camera;
    for (int i = 0; i < 8; ++i) back = orbited(back, {-3, 5, 2}, 0.785398163f);
    expectNear(back.eye, camera.eye, 1e-4f);
}

TEST(Camera, dollyMovesByTheShareOfTheDistance) {
    Camera camera;
    camera.eye = {0, 0, 8};
    expectNear(dollied(camera, 0.25f).eye, {0, 0, 6}, 1e-6f);
    expectNear(dollied(camera, -1).eye, {0, 0, 16}, 1e-6f);
    EXPECT_EQ(dollied(camera, 0.25f).at, camera.at);
    EXPECT_THROW(dollied(camera, 1), std::invalid_argument);
}

TEST(Camera, sceneCameraLooksAlongItsNodesMinusZWhateverTheScale) {
    SceneCamera source;
    source.verticalFov = 0.5f;
    source.nearPlane = 0.2f;
    glm::mat4 node = glm::translate(glm::mat4(1), glm::vec3(1, 2, 3));
    node = glm::rotate(node, 1.5707963f, glm::vec3(0, 1, 0));  // −z becomes −x
    node = glm::scale(node, glm::vec3(100));
    const Camera camera = fromSceneCamera(source, node, 10);
    expectNear(camera.eye, {1, 2, 3}, 1e-5f);
    expectNear(camera.at, {-9, 2, 3}, 1e-5f);
    expectNear(camera.up, {0, 1, 0}, 1e-5f);
    EXPECT_EQ(camera.verticalFov, 0.5f);
    EXPECT_EQ(camera.nearPlane, 0.2f);
    EXPECT_TRUE(std::isfinite(fromSceneCamera(source, glm::mat4(0), 0).viewFromWorld()[0][0]));
}

}  // namespace
}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <lodestar/scene/procedural.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"
#include "visibility_view.hpp"

namespace lodestar::visibility {
namespace {

using small_scenes::facing;
using small_scenes::quad;
using small_scenes::single;

class RebuildTest : public GpuTest {
protected:
    /// Compares weights, depth and normal of every covered pixel with the reference, and the raster
    /// pipeline's depth with both. `weightError` is what 32-bit floats may cost the weights.
    static void expectReference(View& view, const Camera& camera, vk::Extent2D size,
                                double weightError = 2e-3) {
        const Picture p = view.draw(camera, size);
        ASSERT_GT(p.covered(), 0u);
        const glm::dmat3 viewFromWorld(camera.viewFromWorld());
        const glm::dvec2 perPixel = 2.0 / glm::dvec2(size.width, size.height);
        for (std::size_t i = 0; i < p.ids.size(); ++i) {
            if (p.ids[i] == 0) {
                ASSERT_EQ(p.depths[i], 0) << "pixel " << i;
                ASSERT_EQ(p.depthBuffer[i], 0) << "pixel " << i;
                continue;
            }
            const reference::Surface s = view.expected(p, i, camera);
            const reference::Weights& w = s.weights;
            // Inside its triangle, but for the 1/256 pixel to which vertices snap.
            const glm::dvec3 slack =
                glm::abs(w.dx) * perPixel.x / 64.0 + glm::abs(w.dy) * perPixel.y / 64.0 + 1e-5;
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(w.at, -slack))) << "pixel " << i;

            const Found& f = p.found[i];
            ASSERT_LT(glm::length(glm::dvec3(f.at) - w.at), weightError) << "pixel " << i;
            ASSERT_LT(glm::length(glm::dvec3(f.dx) - w.dx), weightError * (1 + glm::length(w.dx)));
            ASSERT_LT(glm::length(glm::dvec3(f.dy) - w.dy), weightError * (1 + glm::length(w.dy)));
            ASSERT_NEAR(f.depth, w.depth, 1e-4 * w.depth) << "pixel " << i;
            ASSERT_NEAR(p.depths[i], w.depth, 1e-4 * w.depth) << "pixel " << i;
            // The raster pipeline interpolates between snapped vertices.
            ASSERT_NEAR(camera.nearPlane / p.depthBuffer[i], w.depth, 0.02 * w.depth);
            const double side =
                glm::dot(viewFromWorld * s.normal, glm::dvec3(p.viewNormal(i))) < 0 ? -1 : 1;
            const glm::dvec3 normal = side * (viewFromWorld * s.normal);
            ASSERT_LT(glm::length(normal - glm::dvec3(p.viewNormal(i))), 2e-3) << "pixel " << i;
        }
    }
};

TEST_F(RebuildTest, spheresEqualTheReferenceAtOddSizes) {
    View view(device(), *scene::buildBuiltin("spheres"));
    const Camera camera = scene::fromSceneCamera(
        view.source.cameras[1], worldFromNode(view.source)[view.source.cameras[1].node], 5);
    for (const vk::Extent2D size : {vk::Extent2D{96, 64}, {17, 33}, {1, 1}}) {
        SCOPED_TRACE(size.width);
        expectReference(view, camera, size);
    }
    // Two pictures of one view are the same to the bit.
    const Picture a = view.draw(camera, {96, 64}), b = view.draw(camera, {96, 64});
    EXPECT_EQ(a.ids, b.ids);
    EXPECT_EQ(a.depths, b.depths);
    for (std::size_t i = 0; i < a.ids.size(); ++i) {
        if (a.ids[i] == 0) continue;  // undefined there
        ASSERT_EQ(a.normals[i], b.normals[i]) << "pixel " << i;
        ASSERT_EQ(a.materials[i], b.materials[i]) << "pixel " << i;
    }
}

TEST_F(RebuildTest, columnsEqualTheReference) {
    View view(device(), *scene::buildBuiltin("columns"));
    const Camera camera = scene::fromSceneCamera(
        view.source.cameras[0], worldFromNode(view.source)[view.source.cameras[0].node], 10);
    expectReference(view, camera, {96, 64});
}

TEST_F(RebuildTest, turnedStretchedAndReflectedInstancesEqualTheReference) {
    View view(device(), small_scenes::jumble());
    expectReference(view, scene::frame(view.onGpu.bounds(), 1.5f), {96, 64});
}

TEST_F(RebuildTest, showsTheNearestFrontFacingTriangle) {
    small_scenes::Random random(5);
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 60; ++i) {
        const glm::vec3 centre = random.vec3(-1, 1);
        for (int k = 0; k < 3; ++k) corners.push_back(centre + random.vec3(-0.5f, 0.5f));
    }
    View view(device(), single(small_scenes::triangles(corners)));
    const Camera camera{.eye = {0.3f, 0.4f, 3}, .at = {0, 0, 0}};
    const vk::Extent2D size{64, 48};
    const Picture p = view.draw(camera, size);
    const glm::dmat4 clip(View::clipFromWorld(camera, size));

    int compared = 0;
    for (std::size_t i = 0; i < p.ids.size(); ++i) {
        std::size_t nearest = 0, second = 0;  // 0 = none
        double depth = 1e30, secondDepth = 1e30;
        bool nearEdge = false;
        for (std::size_t t = 0; t < corners.size(); t += 3) {
            reference::Triangle triangle{.world = {corners[t], corners[t + 1], corners[t + 2]}};
            const glm::dvec3 face = glm::cross(triangle.world[1] - triangle.world[0],
                                               triangle.world[2] - triangle.world[0]);
            triangle.normal = {face, face, face};
            const auto s = reference::rebuild(triangle, clip, p.centre(i), {64, 48});
            const auto& w = s.weights;
            const double least = std::min({w.at.x, w.at.y, w.at.z});
            const glm::dvec3 pixel = glm::abs(w.dx) * (2.0 / 64) + glm::abs(w.dy) * (2.0 / 48);
            const double width = std::max({pixel.x, pixel.y, pixel.z}) / 32;
            if (w.depth < 0.01 || glm::dot(face, glm::dvec3(camera.eye) - triangle.world[0]) <= 0)
                continue;
            nearEdge |= std::abs(least) < width;
            if (least < 0) continue;
            if (w.depth < depth) {
                second = nearest;
                secondDepth = depth;
                nearest = t / 3 + 1;
                depth = w.depth;
            } else if (w.depth < secondDepth) {
                second = t / 3 + 1;
                secondDepth = w.depth;
            }
        }
        if (nearEdge || (second && secondDepth < depth * 1.01)) continue;  // either is right
        ++compared;
        if (nearest == 0) {
            ASSERT_EQ(p.ids[i], 0u) << "pixel " << i;
            continue;
        }
        ASSERT_NE(p.ids[i], 0u) << "pixel " << i;
        const auto seen = view.triangle(p.ids[i]).world;
        for (int k = 0; k < 3; ++k)
            ASSERT_EQ(seen[k], glm::dvec3(corners[3 * (nearest - 1) + std::size_t(k)])) << i;
    }
    EXPECT_GT(compared, 64 * 48 * 8 / 10);
    EXPECT_GT(p.covered(), p.ids.size() / 4);
}

TEST_F(RebuildTest, aFloorThroughTheNearPlaneIsExact) {
    // At z = 0 a vertex has w = 0; just before it, it projects millions of pixels away.
    for (const float behind : {100.0f, 0.0f, -1e-6f, -1e-3f}) {
        View view(device(), single(small_scenes::triangles({{-100, 0, behind},
                                                            {100, 0, behind},
                                                            {100, 0, -100},
                                                            {-100, 0, behind},
                                                            {100, 0, -100},
                                                            {-100, 0, -100}})));
        const Camera camera{.eye = {0, 1.5f, 0}, .at = {0, 1.5f, -1}, .verticalFov = 1.2f};
        const vk::Extent2D size{64, 48};
        const Picture p = view.draw(camera, size);
        const double halfHeight = std::tan(0.6), halfWidth = halfHeight * 64 / 48;
        int hits = 0;
        for (std::size_t i = 0; i < p.ids.size(); ++i) {
            const glm::dvec2 ndc =
                glm::dvec2(p.centre(i)) / glm::dvec2(size.width, size.height) * 2.0 - 1.0;
            const double down = ndc.y * halfHeight;  // of the ray at distance 1
            if (down <= 0) {
                ASSERT_EQ(p.ids[i], 0u);
                continue;
            }
            const double depth = 1.5 / down, x = depth * ndc.x * halfWidth;
            if (depth > 95 || std::abs(x) > 95) continue;
            ++hits;
            ASSERT_NE(p.ids[i], 0u) << "pixel " << i;
            EXPECT_NEAR(p.depths[i], depth, 2e-5 * depth) << "pixel " << i;
            EXPECT_NEAR(camera.nearPlane / p.depthBuffer[i], depth, 1e-3 * depth);
            const auto& f = p.found[i];
            const auto expected = view.expected(p, i, camera).weights;
            EXPECT_LT(glm::length(glm::dvec3(f.at) - expected.at), 1e-4);
        }
        EXPECT_GT(hits, 64 * 20);
    }
}

TEST_F(RebuildTest, depthOfASlantedPlaneIsAnalytic) {
    const glm::mat4 tilt = glm::rotate(glm::mat4(1), 0.9f, glm::normalize(glm::vec3(1, 0.4f, 0)));
    Scene scene = single(quad());
    scene.nodes.back().hasMatrix = true;
    scene.nodes.back().matrix = glm::scale(tilt, {3, 3, 1});
    View view(device(), std::move(scene));
    const Camera camera = facing(4);
    const Picture p = view.draw(camera, {33, 33});
    EXPECT_EQ(p.covered(), p.ids.size());
    const glm::dvec3 normal(tilt[2]);
    for (std::size_t i = 0; i < p.ids.size(); ++i) {
        const glm::dvec2 xy = (glm::dvec2(p.centre(i)) / 33.0 * 2.0 - 1.0) / 4.0;
        const glm::dvec3 ray(xy.x, -xy.y, -1);
        const double depth = -4 * normal.z / glm::dot(normal, ray);
        EXPECT_NEAR(p.depths[i], depth, 1e-5 * depth);
        EXPECT_NEAR(camera.nearPlane / p.depthBuffer[i], depth, 1e-4 * depth);
        EXPECT_LT(glm::length(p.viewNormal(i) - glm::vec3(normal)), 1e-3f);
    }
}

TEST_F(RebuildTest, backgroundHasIdAndDepthZero) {
    View view(device(), single(quad()));
    Camera away = facing();
    away.at = {0, 0, 20};
    const Picture p = view.draw(away, {16, 16});
    EXPECT_EQ(p.covered(), 0u);
    EXPECT_EQ(p.depths, std::vector<float>(256, 0.0f));
}

TEST_F(RebuildTest, backFacesShowOnlyWhenDoubleSidedAndTurnTheirNormals) {
    scene::Material material;
    Camera behind = facing();
    behind.eye.z = -behind.eye.z;
    View oneSided(device(), single(quad(), material));
    EXPECT_EQ(oneSided.draw(facing(), {16, 16}).covered(), 256u);
    EXPECT_EQ(oneSided.draw(behind, {16, 16}).covered(), 0u);

    material.doubleSided = true;
    View twoSided(device(), single(quad(), material));
    for (const Camera& camera : {facing(), behind}) {
        const Picture p = twoSided.draw(camera, {16, 16});
        ASSERT_EQ(p.covered(), 256u);
        for (std::size_t i = 0; i < p.ids.size(); ++i)
            EXPECT_LT(glm::length(p.viewNormal(i) - glm::vec3(0, 0, 1)), 1e-3f);
    }
}

TEST_F(RebuildTest, reflectedInstancesKeepTheirFront) {
    Scene scene = single(quad());
    scene.nodes.back().hasMatrix = true;
    scene.nodes.back().matrix = glm::scale(glm::mat4(1), {-1, 1, 1});
    View view(device(), std::move(scene));
    const Picture p = view.draw(facing(), {16, 16});
    EXPECT_EQ(p.covered(), 256u);
    for (std::size_t i = 0; i < p.ids.size(); ++i)
        EXPECT_LT(glm::length(p.viewNormal(i) - glm::vec3(0, 0, 1)), 1e-3f);
    Camera behind = facing();
    behind.eye.z = -behind.eye.z;
    EXPECT_EQ(view.draw(behind, {16, 16}).covered(), 0u);
}

TEST(RebuildReference, equalsTheThesisFormulasInFrontOfTheEye) {
    // Perspective division first, then screen-space barycentrics and 1/w (design, §3).
    small_scenes::Random random(11);
    for (int round = 0; round < 200; ++round) {
        std::array<glm::dvec4, 3> clip;
        for (auto& v : clip) v = glm::dvec4(random.vec3(-3, 3), random(0.5f, 8));
        const glm::dvec2 point(random(-1, 1), random(-1, 1));
        std::array<glm::dvec2, 3> v;
        glm::dvec3 perW;
        for (int i = 0; i < 3; ++i) {
            v[i] = glm::dvec2(clip[i]) / clip[i].w;
            perW[i] = 1 / clip[i].w;
        }
        const double d = glm::determinant(glm::dmat2(v[2] - v[1], v[0] - v[1]));
        if (std::abs(d) < 0.05) continue;
        const glm::dvec3 dx = glm::dvec3(v[1].y - v[2].y, v[2].y - v[0].y, v[0].y - v[1].y) / d;
        const glm::dvec3 dy = glm::dvec3(v[2].x - v[1].x, v[0].x - v[2].x, v[1].x - v[0].x) / d;
        const glm::dvec2 delta = point - v[0];
        const glm::dvec3 screen = glm::dvec3(1, 0, 0) + dx * delta.x + dy * delta.y;
        const double w = 1 / glm::dot(screen, perW);
        if (!(w > 0.1 && w < 100)) continue;
        const auto weights = reference::weightsAt(clip, point);
        EXPECT_NEAR(weights.depth, w, 1e-8 * w);
        EXPECT_LT(glm::length(weights.at - screen * perW * w), 1e-7 * glm::length(weights.at));
    }
}

TEST(RebuildReference, derivativesAreFiniteDifferences) {
    small_scenes::Random random(12);
    const Camera camera{.eye = {0, 0, 4}, .at = {0, 0, 0}};
    const glm::dmat4 clip(View::clipFromWorld(camera, {40, 30}));
    for (int round = 0; round < 100; ++round) {
        reference::Triangle t;
        for (int i = 0; i < 3; ++i) {
            t.world[i] = random.vec3(-1, 1);
            t.normal[i] = {0, 0, 1};
            t.uv[i] = glm::dvec2(random.vec3(0, 1));
        }
        const glm::dvec3 face =
            glm::normalize(glm::cross(t.world[1] - t.world[0], t.world[2] - t.world[0]));
        if (std::abs(face.z) < 0.3) continue;
        const glm::dvec2 point(random(10, 30), random(8, 22)), size(40, 30);
        const auto at = [&](glm::dvec2 p) { return reference::rebuild(t, clip, p, size).uv; };
        const auto s = reference::rebuild(t, clip, point, size);
        constexpr double kStep = 1e-4;
        const glm::dvec2 dx =
            (at(point + glm::dvec2(kStep, 0)) - at(point - glm::dvec2(kStep, 0))) / (2 * kStep);
        const glm::dvec2 dy =
            (at(point + glm::dvec2(0, kStep)) - at(point - glm::dvec2(0, kStep))) / (2 * kStep);
        EXPECT_LT(glm::length(s.uvDx - dx), 1e-6 * (1 + glm::length(dx)));
        EXPECT_LT(glm::length(s.uvDy - dy), 1e-6 * (1 + glm::length(dy)));
    }
}

}  // namespace
}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
// Sky, sun fit and the shadow equation; shading_gpu_test.cpp holds the shaders to them.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <lodestar/shared/octahedral.h>
#include <lodestar/shading/sky.hpp>
#include "shadow_scenes.hpp"

namespace lodestar::shading {
namespace {

using glm::dvec3;
using glm::vec3;

const vec3 kUp{0, 1, 0};

bool finite(vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// skyIrradiance() of sky.glsl.
vec3 irradianceAt(const std::array<vec3, 9>& sh, vec3 n) {
    return sh[0] + sh[1] * n.y + sh[2] * n.z + sh[3] * n.x + sh[4] * (n.x * n.y) +
           sh[5] * (n.y * n.z) + sh[6] * (3 * n.z * n.z - 1) + sh[7] * (n.x * n.z) +
           sh[8] * (n.x * n.x - n.y * n.y);
}

std::vector<vec3> directions(int count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    std::vector<vec3> result;
    while (int(result.size()) < count) {
        const float x = normal(random), y = normal(random), z = normal(random);
        result.push_back(glm::normalize(vec3(x, y, z)));
    }
    return result;
}

vec3 sunAt(float degrees) {
    const float a = glm::radians(degrees);
    return {std::cos(a), std::sin(a), 0};
}

TEST(Sky, radianceIsFiniteAndNotNegativeForEverySun) {
    for (const float height : {-90.f, -30.f, -2.f, 0.f, 0.5f, 5.f, 45.f, 89.9f, 90.f}) {
        const Sky sky(sunAt(height));
        EXPECT_TRUE(finite(sky.sunIlluminance()));
        std::vector<vec3> tried = directions(200, 1);
        tried.insert(tried.end(), {kUp, -kUp, {1, 0, 0}, {0, 0, 1}, sky.toSun(), -sky.toSun()});
        for (const vec3 d : tried) {
            const vec3 l = sky.radiance(d);
            ASSERT_TRUE(finite(l)) << "sun at " << height;
            ASSERT_GE(std::min({l.x, l.y, l.z}), 0) << "sun at " << height;
        }
        for (const vec3 sh : sky.irradiance()) EXPECT_TRUE(finite(sh)) << "sun at " << height;
    }
}

TEST(Sky, daylightComesFromSunAndSky) {
    const Sky sky(sunAt(50));
    EXPECT_NEAR(glm::dot(sky.sunIlluminance(), vec3(0.2126f, 0.7152f, 0.0722f)), 3.5f, 0.01f);
    const vec3 fromSky = irradianceAt(sky.irradiance(), kUp);
    EXPECT_GT(std::min({fromSky.x, fromSky.y, fromSky.z}), 0.1f);
    EXPECT_LT(std::max({fromSky.x, fromSky.y, fromSky.z}), 3.5f);  // less than the sun gives
    EXPECT_GT(fromSky.z, fromSky.x);                               // and blue
}

TEST(Sky, noSunlightFromBelowTheHorizon) {
    EXPECT_EQ(Sky(sunAt(-1)).sunIlluminance(), vec3(0));
    EXPECT_EQ(Sky(sunAt(-90)).sunIlluminance(), vec3(0));
}

TEST(Sky, aLowSunIsRedder) {
    const auto redness = [](float height) {
        const vec3 sun = Sky(sunAt(height)).sunIlluminance();
        return sun.x / sun.z;
    };
    EXPECT_LT(redness(90), 1.6f);
    EXPECT_GT(redness(30), redness(90));
    EXPECT_GT(redness(10), 1.2f * redness(30));
    EXPECT_GT(redness(3), 2 * redness(30));
}

// Under a high sun the sunlit ground outshines the blue sky, so that it is sun and sky together
// that must outweigh what comes from below: the ground sends back about its albedo of 0.2.
TEST(Sky, theGroundSendsBackItsAlbedo) {
    for (const float height : {10.f, 45.f, 90.f}) {
        const Sky sky(sunAt(height));
        const auto sh = sky.irradiance();
        const float onGround = irradianceAt(sh, kUp).y + sky.sunIlluminance().y * sky.toSun().y;
        const float share = irradianceAt(sh, -kUp).y / onGround;
        EXPECT_GT(share, 0.15f) << "sun at " << height;
        EXPECT_LT(share, 0.30f) << "sun at " << height;
    }
}

TEST(Sky, underALowSunTheSkyOutshinesTheGround) {
    const auto sh = Sky(sunAt(10)).irradiance();
    EXPECT_GT(irradianceAt(sh, kUp).y, 1.2f * irradianceAt(sh, -kUp).y);
}

TEST(Irradiance, constantSkyGivesPiEverywhere) {
    const auto sh = irradianceOf([](vec3) { return vec3(1, 2, 0.5f); });
    for (const vec3 n : directions(100, 2)) {
        const vec3 e = irradianceAt(sh, n) / 3.14159265f;
        EXPECT_NEAR(e.x, 1, 2e-3);
        EXPECT_NEAR(e.y, 2, 4e-3);
        EXPECT_NEAR(e.z, 0.5, 1e-3);
    }
}

// Radiance 1 + d·a integrates against a cosine to π + 2π/3 n·a, within the nine polynomials.
TEST(Irradiance, linearSkyFollowsItsGradient) {
    const vec3 a{0.3f, -0.5f, 0.7f};
    const auto sh = irradianceOf([&](vec3 d) { return vec3(1 + glm::dot(d, a)); });
    for (const vec3 n : directions(100, 3))
        EXPECT_NEAR(irradianceAt(sh, n).x, 3.14159265 * (1 + 2.0 / 3 * glm::dot(n, a)), 0.01);
}

// A sky of one band-2 polynomial keeps its shape, times π/4: pins each basis function's constant.
TEST(Irradiance, quadraticSkiesKeepTheirShape) {
    const std::vector<std::function<float(vec3)>> shapes{
        [](vec3 d) { return d.x * d.y; },
        [](vec3 d) { return d.y * d.z; },
        [](vec3 d) { return 3 * d.z * d.z - 1; },
        [](vec3 d) { return d.x * d.z; },
        [](vec3 d) { return d.x * d.x - d.y * d.y; },
    };
    for (const auto& shape : shapes) {
        const auto sh = irradianceOf([&](vec3 d) { return vec3(shape(d)); });
        for (const vec3 n : directions(50, 4))
            EXPECT_NEAR(irradianceAt(sh, n).x, 3.14159265 / 4 * shape(n), 0.01);
    }
}

TEST(SkyMap, levelZeroIsTheSkyAtTexelCentres) {
    const Sky sky(sunAt(35));
    const SkyMap map = makeSkyMap(sky);
    constexpr int n = SkyMap::kSize;
    std::mt19937 random(5);
    for (int i = 0; i < 300; ++i) {
        const int x = int(random() % n), y = int(random() % n);
        const vec3 e = shared::octahedralDecode(
            {(float(x) + 0.5f) / n * 2 - 1, (float(y) + 0.5f) / n * 2 - 1});
        const vec3 expected = sky.radiance({e.x, e.z, e.y});  // the map's middle is straight up
        const vec3 stored = map.levels[0][std::size_t(y * n + x)];
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(stored[c], expected[c], 1e-5f * (1 + expected[c]));
    }
}

TEST(SkyMap, levelsHalveAndBlur) {
    const SkyMap map = makeSkyMap(Sky(sunAt(35)));
    float before = INFINITY;
    for (int level = 0; level < SkyMap::kLevels; ++level) {
        const auto& texels = map.levels[std::size_t(level)];
        ASSERT_EQ(int(texels.size()), (SkyMap::kSize >> level) * (SkyMap::kSize >> level));
        float brightest = 0;
        for (const glm::vec4& t : texels) brightest = std::max(brightest, t.y);
        EXPECT_LT(brightest, before) << "level " << level;
        before = brightest;
    }
}

std::vector<vec3> cornersOf(const scene::Bounds& b) {
    std::vector<vec3> corners;
    for (int i = 0; i < 8; ++i)
        corners.push_back({i & 1 ? b.upper.x : b.lower.x, i & 2 ? b.upper.y : b.lower.y,
                           i & 4 ? b.upper.z : b.lower.z});
    return corners;
}

vec3 clip(const LightView& sun, vec3 p) {
    return vec3(sun.clipFromWorld * glm::vec4(p, 1));
}

const scene::Bounds kHall{{-20, 0, -8}, {15, 9, 8}};

TEST(SunFit, sceneLiesInsideMapAndDepthRange) {
    for (const vec3 toSun : directions(50, 6)) {
        const LightView sun = fitSun(toSun, kHall, {}, 1.5f, 1e5f, 1024);
        for (const vec3 p : cornersOf(kHall)) {
            const vec3 c = clip(sun, p);
            EXPECT_LT(std::max(std::abs(c.x), std::abs(c.y)), 1);
            EXPECT_GT(c.z, 0);
            EXPECT_LT(c.z, 1);
        }
    }
}

TEST(SunFit, nearerTheSunIsDeeper) {
    const vec3 toSun = glm::normalize(vec3(0.3f, 0.8f, -0.2f));
    const LightView sun = fitSun(toSun, kHall, {}, 1, 1e5f, 512);
    EXPECT_NEAR(clip(sun, toSun * 2.f).z - clip(sun, vec3(0)).z, 2 * sun.depthScale, 1e-6);
}

/// A view that sees less than the hall, so that the map covers the view only.
scene::Camera closeUp(vec3 eye, vec3 at) {
    return {.eye = eye, .at = at, .verticalFov = 0.8f, .nearPlane = 0.01f};
}

TEST(SunFit, aCloseViewIsCoveredAndCastersBeyondItKeepTheirDepth) {
    const float aspect = 1.6f, distance = 5;
    for (const vec3 toSun : directions(40, 7)) {
        const scene::Camera camera =
            closeUp({-10, 2, 0.3f}, vec3(-10, 2, 0.3f) + vec3(toSun.z, toSun.x, toSun.y));
        const LightView sun = fitSun(toSun, kHall, camera, aspect, distance, 1024);
        EXPECT_LT(sun.texel, 0.6f * fitSun(toSun, kHall, camera, aspect, 1e5f, 1024).texel);
        // The view's pyramid, whose corners lie at `distance` along the axis.
        const glm::mat4 worldFromView = glm::inverse(camera.viewFromWorld());
        const float t = std::tan(camera.verticalFov / 2) * distance;
        for (const float x : {-1.f, 1.f})
            for (const float y : {-1.f, 1.f}) {
                const vec3 c =
                    clip(sun, vec3(worldFromView * glm::vec4(x * t * aspect, y * t, -distance, 1)));
                EXPECT_LE(std::max(std::abs(c.x), std::abs(c.y)), 1);
            }
        const vec3 eye = clip(sun, camera.eye);
        EXPECT_LE(std::max(std::abs(eye.x), std::abs(eye.y)), 1);
        for (const vec3 p : cornersOf(kHall)) {
            EXPECT_GT(clip(sun, p).z, 0);
            EXPECT_LT(clip(sun, p).z, 1);
        }
    }
}

TEST(SunFit, smallCameraMovesLeaveItAndLargeOnesShiftItByWholeTexels) {
    const vec3 toSun{0.5f, 0.8f, 0.35f};
    const auto fitAt = [&](float x) {
        return fitSun(toSun, kHall, closeUp({x, 2, 0}, {x + 1, 2, 0.4f}), 1.6f, 5, 1024);
    };
    const LightView first = fitAt(-10);
    LightView before = first;
    int changes = 0;
    for (int i = 1; i <= 400; ++i) {
        const LightView now = fitAt(-10 + 0.01f * float(i));
        if (now == before) continue;
        ++changes;
        before = now;
        const glm::vec4 shift = now.mapFromWorld[3] - first.mapFromWorld[3];
        EXPECT_EQ(now.texel, first.texel);
        EXPECT_NEAR(shift.x, std::round(shift.x), 0.01);
        EXPECT_NEAR(shift.y, std::round(shift.y), 0.01);
        EXPECT_EQ(shift.z, 0);
    }
    EXPECT_GT(changes, 0);
    EXPECT_LT(changes, 15);  // of 400 moves
}

TEST(SunFit, bothMatricesNameTheSameTexel) {
    for (const vec3 toSun : directions(20, 8)) {
        const LightView sun = fitSun(toSun, kHall, closeUp({0, 1, 0}, {1, 1, 0}), 1, 5, 1024);
        for (const vec3 p : directions(20, 9)) {
            const vec3 c = clip(sun, p), s = vec3(sun.mapFromWorld * glm::vec4(p, 1));
            EXPECT_NEAR(s.x, (c.x + 1) / 2 * 1024, 1e-2);
            EXPECT_NEAR(s.y, (c.y + 1) / 2 * 1024, 1e-2);
            EXPECT_NEAR(s.z, c.z, 1e-6);
            // The shader's rows: the same texel and depth; a texel is as long as it says.
            const shared::GpuLightView rows = sun.params();
            EXPECT_NEAR(glm::dot(rows.u, glm::vec4(p, 1)), s.x, 1e-2);
            EXPECT_NEAR(glm::dot(rows.v, glm::vec4(p, 1)), s.y, 1e-2);
            EXPECT_NEAR(glm::dot(rows.depth, glm::vec4(p, 1)), s.z, 1e-6);
            EXPECT_NEAR(glm::length(vec3(rows.u)) * sun.texel, 1, 1e-4);
            EXPECT_NEAR(glm::dot(vec3(rows.u), vec3(rows.v)), 0, 1e-3);
        }
    }
}

TEST(SkyFit, viewsLookDownFromEverywhereAndHoldTheScene) {
    const Sky sky({0.3f, 0.8f, 0.2f});
    const auto views = fitSky(sky, kHall, 16, 256);
    ASSERT_EQ(views.size(), 16u);
    vec3 sum{0};
    for (const LightView& view : views) {
        EXPECT_GT(view.toLight.y, 0);
        EXPECT_NEAR(glm::length(view.toLight), 1, 1e-5);
        EXPECT_GT(view.weight, 0);
        sum += view.toLight;
        for (int corner = 0; corner < 8; ++corner) {
            const vec3 p(corner & 1 ? kHall.upper.x : kHall.lower.x,
                         corner & 2 ? kHall.upper.y : kHall.lower.y,
                         corner & 4 ? kHall.upper.z : kHall.lower.z);
            const vec3 at(view.mapFromWorld * glm::vec4(p, 1));
            for (int axis = 0; axis < 2; ++axis) {
                EXPECT_GT(at[axis], 0);
                EXPECT_LT(at[axis], 256);
            }
            EXPECT_GT(at.z, 0);
            EXPECT_LT(at.z, 1);
        }
    }
    // Spread over the hemisphere: their mean is straight up, half a unit long.
    EXPECT_NEAR(sum.x / 16, 0, 0.05);
    EXPECT_NEAR(sum.y / 16, 0.5, 0.01);
    EXPECT_NEAR(sum.z / 16, 0, 0.05);
    EXPECT_TRUE(fitSky(sky, kHall, 0, 256).empty());
}

TEST(SunFit, emptySceneAndZenithSunAreFinite) {
    for (const vec3 toSun : {kUp, -kUp, vec3(1, 0, 0)}) {
        const LightView sun = fitSun(toSun, {}, {}, 1, 0, 64);
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) EXPECT_TRUE(std::isfinite(sun.mapFromWorld[i][j]));
    }
}

}  // namespace
}  // namespace lodestar::shading

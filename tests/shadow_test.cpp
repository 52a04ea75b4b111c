// SPDX-License-Identifier: Apache-2.0
// The shadow equation on maps made on the CPU; shading_gpu_test.cpp holds the shader to it.
#include <lodestar/shading/light_visibility_reference.hpp>

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "shadow_scenes.hpp"

namespace lodestar::shading {
namespace {

using glm::dvec3;
using glm::vec3;

const dvec3 kUp{0, 1, 0};
constexpr int kTaps[] = {1, 2, 3, 5, 9};

/// A square of side 1 at a height of 0.5 over a floor, its shadow under a sun at the zenith the
/// same square.
ShadowScene floatingSquare(int taps, vec3 toSun = {0, 1, 0}) {
    return {toSun, taps, {floorQuad(2), {{-0.5, 0.5, -0.5}, {0, 0, 1}, {1, 0, 0}}}};
}

TEST(Shadow, litFarFromTheSquareAndDarkBelowIt) {
    for (const int taps : kTaps) {
        const ShadowScene scene = floatingSquare(taps);
        EXPECT_NEAR(scene.visibility({1.2, 0, 0.3}, kUp), 1, 1e-9) << taps;
        EXPECT_EQ(scene.visibility({0, 0, 0}, kUp), 0) << taps;
        EXPECT_NEAR(scene.visibility({0, 0.5, 0}, kUp), 1, 1e-9) << "on the square, " << taps;
    }
}

TEST(Shadow, windowsOverTheEdgeOfTheMapAreLit) {
    const ShadowScene scene = floatingSquare(9);
    EXPECT_EQ(scene.visibility({100, 0, 0}, kUp), 1);
    EXPECT_EQ(scene.visibility({0, 0, -100}, kUp), 1);
}

TEST(Shadow, penumbraIsNTexelsWideAndMonotone) {
    for (const int taps : kTaps) {
        const ShadowScene scene = floatingSquare(taps);
        double before = 0, lastDark = 0, firstLit = 0;
        for (double x = 0; x < 1.2; x += 0.01 * scene.sun.texel) {
            const double v = scene.visibility({x, 0, 0.1}, kUp);
            EXPECT_GE(v, before - 1e-9) << taps;
            before = v;
            if (v <= 1e-9) lastDark = x;
            if (v >= 1 - 1e-9 && firstLit == 0) firstLit = x;
        }
        EXPECT_NEAR((firstLit - lastDark) / scene.sun.texel, taps, 0.05) << taps;
        // Half-way lies at the square's edge, as well as a map of texels can say.
        EXPECT_NEAR((firstLit + lastDark) / 2, 0.5, 0.51 * scene.sun.texel) << taps;
    }
}

TEST(Shadow, continuousUnderMotionOfAFractionOfATexel) {
    for (const int taps : kTaps) {
        const ShadowScene scene = floatingSquare(taps, {0.3f, 0.8f, -0.4f});
        const dvec3 step = dvec3(0.02, 0, 0.013) * double(scene.sun.texel);
        const double most = 2.0 * 0.033 / taps;  // of both axes, if all texels differ
        double before = -1, lowest = 1, highest = 0;
        for (dvec3 p{-1.2, 0, -0.8}; p.x < 1.2; p += step) {
            const double v = scene.visibility(p, kUp);
            if (before >= 0) {
                ASSERT_LE(std::abs(v - before), most) << taps << " at " << p.x;
            }
            before = v;
            lowest = std::min(lowest, v);
            highest = std::max(highest, v);
        }
        EXPECT_LT(lowest, 0.1);  // the way led through the shadow
        EXPECT_GT(highest, 1 - 1e-9);
    }
}

TEST(Shadow, tiltedPlanesDoNotShadowThemselves) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> unit(0, 1);
    const vec3 toSun = glm::normalize(vec3(0.5f, 0.8f, 0.35f));
    for (int i = 0; i < 100; ++i) {
        const double tilt = glm::radians(80.0) * unit(random), turn = 6.2831853 * unit(random);
        const dvec3 right = glm::normalize(glm::cross(kUp, dvec3(toSun)));
        const dvec3 up = glm::cross(dvec3(toSun), right);
        const dvec3 aside = std::cos(turn) * right + std::sin(turn) * up;
        const dvec3 normal = std::cos(tilt) * dvec3(toSun) + std::sin(tilt) * aside;
        const dvec3 a = glm::normalize(glm::cross(dvec3(toSun), aside)), b = glm::cross(normal, a);
        const ShadowScene scene(toSun, 9, {{-2.0 * a - 2.0 * b, 4.0 * a, 4.0 * b}});
        for (int k = 0; k < 40; ++k) {
            const dvec3 p = (unit(random) - 0.5) * a + (unit(random) - 0.5) * b;
            ASSERT_GT(scene.visibility(p, normal), 1 - 1e-9) << glm::degrees(tilt) << " degrees";
        }
    }
}

// A wall stands on the floor; its shadow starts at most 2 texels from its foot.
TEST(Shadow, contactShadowsStartWithinTwoTexels) {
    for (const double height : {15.0, 30.0, 45.0, 60.0, 75.0})
        for (const double foot : {0.0, 0.003, 0.011, 0.017}) {
            const double a = glm::radians(height);
            const vec3 toSun(float(-std::cos(a)), float(std::sin(a)), 0);
            const ShadowScene scene(toSun, 1,
                                    {floorQuad(2), {{foot, 0, -1.5}, {0, 1.5, 0}, {0, 0, 3}}});
            const double texel = scene.sun.texel / std::sin(a);  // on the floor
            double gap = 0;
            while (gap < 10 && scene.visibility({foot + gap * texel, 0, 0.1}, kUp) > 0.5)
                gap += 0.05;
            EXPECT_LT(gap, 2) << "sun at " << height << " degrees";
            EXPECT_NEAR(scene.visibility({foot - 3 * texel, 0, 0.1}, kUp), 1, 1e-9)
                << "on the sun's side";
        }
}

TEST(Shadow, aPlateCloseToTheFloorStillShadowsIt) {
    const ShadowScene probe = floatingSquare(3);
    const double gap = 3 * probe.sun.texel;
    const ShadowScene scene({0.2f, 0.9f, 0.1f}, 3,
                            {floorQuad(2), {{-0.5, gap, -0.5}, {0, 0, 1}, {1, 0, 0}}});
    EXPECT_EQ(scene.visibility({0, 0, 0}, kUp), 0);
}

}  // namespace
}  // namespace lodestar::shading

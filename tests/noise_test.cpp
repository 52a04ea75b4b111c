// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shared/noise.h>

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace lodestar::shared {
namespace {

TEST(Noise, isZeroAtLatticePointsAndBounded) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> anywhere(-50, 50);
    double sum = 0, squares = 0;
    constexpr int kSamples = 20000;
    for (int i = 0; i < kSamples; ++i) {
        const glm::vec3 p(anywhere(random), anywhere(random), anywhere(random));
        EXPECT_EQ(perlin(glm::floor(p)), 0);
        const float value = perlin(p);
        ASSERT_LE(std::abs(value), 1);
        sum += value;
        squares += double(value) * value;
    }
    EXPECT_NEAR(sum / kSamples, 0, 0.01) << "no bias";
    EXPECT_GT(squares / kSamples, 0.03) << "and not flat";
}

TEST(Noise, slopeIsThatOfTheValue) {
    std::mt19937 random(4);
    std::uniform_real_distribution<float> anywhere(-9, 9);
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 p(anywhere(random), anywhere(random), anywhere(random));
        const glm::vec4 slope = perlinSlope(p);
        EXPECT_NEAR(slope.w, perlin(p), 1e-6f);
        constexpr float kStep = 1e-2f;
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec3 before = p, after = p;
            before[axis] -= kStep;
            after[axis] += kStep;
            EXPECT_NEAR(slope[axis], (perlin(after) - perlin(before)) / (2 * kStep), 2e-3f);
        }
    }
}

TEST(Noise, isSmoothAcrossCellBorders) {
    constexpr float kStep = 1e-3f;
    for (int axis = 0; axis < 3; ++axis)
        for (float at = -2; at < 2; at += 0.0173f) {
            glm::vec3 p(0.37f, 1.61f, -0.83f), q;
            p[axis] = at;
            q = p;
            q[axis] += kStep;
            EXPECT_LT(std::abs(perlin(q) - perlin(p)), 4 * kStep) << axis << ' ' << at;
        }
}

TEST(Noise, octavesAddDetailAndStayInRange) {
    double rough[2] = {0, 0};
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 p(0.013f * float(i), 0.7f, 0.2f), q = p + glm::vec3(0.013f, 0, 0);
        for (int k = 0; k < 2; ++k) {
            const int octaves = k == 0 ? 1 : 6;
            ASSERT_LE(std::abs(fractalNoise(p, octaves)), 1);
            rough[k] += std::abs(fractalNoise(q, octaves) - fractalNoise(p, octaves));
        }
    }
    EXPECT_GT(rough[1], rough[0]);
    EXPECT_EQ(fractalNoise({0.3f, 0.4f, 0.5f}, 0), 0);
}

TEST(Noise, warpsMoveThePatternAndKeepItContinuousAndInRange) {
    double moved = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 p(0.013f * float(i), 0.7f, 0.2f), q = p + glm::vec3(1e-4f, 0, 0);
        EXPECT_EQ(warpedNoise(p, 4, 0), fractalNoise(p, 4));
        for (int warps = 1; warps <= 3; ++warps) {
            ASSERT_LE(std::abs(warpedNoise(p, 4, warps)), 1);
            EXPECT_LT(std::abs(warpedNoise(q, 4, warps) - warpedNoise(p, 4, warps)), 0.02f);
        }
        moved += std::abs(warpedNoise(p, 4, 1) - fractalNoise(p, 4));
    }
    EXPECT_GT(moved / 2000, 0.02);
}

}  // namespace
}  // namespace lodestar::shared

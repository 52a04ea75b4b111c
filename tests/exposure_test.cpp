// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/exposure.hpp>

#include <vector>

#include <gtest/gtest.h>

namespace lodestar::post {
namespace {

using glm::vec4;

TEST(Exposure, bringsGreysToTheSameKey) {
    for (const float grey : {0.02f, 0.1f, 0.3f}) {
        const std::vector<vec4> picture(64, vec4(grey, grey, grey, 1));
        EXPECT_NEAR(meteredExposure(picture) * grey, 0.12f, 1e-4f) << grey;
    }
}

TEST(Exposure, isTheGeometricMeanSoThatASmallLampDoesNotDarkenTheRoom) {
    std::vector<vec4> room(1000, vec4(0.1f, 0.1f, 0.1f, 1));
    const float without = meteredExposure(room);
    for (int i = 0; i < 10; ++i) room[std::size_t(i)] = vec4(1000, 1000, 1000, 1);
    EXPECT_GT(meteredExposure(room), 0.9f * without);
}

TEST(Exposure, unlitTexelsDoNotCountAndBlackIsBounded) {
    EXPECT_EQ(meteredExposure({}), 1);
    const std::vector<vec4> unlit(4, vec4(1, 1, 1, 0));
    EXPECT_EQ(meteredExposure(unlit), 1);
    const std::vector<vec4> black(4, vec4(0, 0, 0, 1));
    EXPECT_EQ(meteredExposure(black), 16);
}

}  // namespace
}  // namespace lodestar::post

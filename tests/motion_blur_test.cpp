// SPDX-License-Identifier: Apache-2.0
// Motion blur alone.
#include <lodestar/post/effective.hpp>
#include <lodestar/post/motion_blur.hpp>

#include "post_fixture.hpp"

namespace lodestar::post {
namespace {

using glm::ivec2;
using glm::vec3;

class MotionBlurTest : public PostTest {
protected:
    static constexpr ivec2 kSize{128, 40};
    static constexpr int kEdge = 64;
    /// What lies left and right of the edge: colour, depth, and pixels moved since the last frame.
    struct Side {
        float color, depth, moved;
    };
    static std::vector<float> run(int side, const Side& left, const Side& right,
                                  float shutter = 1) {
        std::vector<vec3> rgb;
        std::vector<float> z;
        std::vector<glm::vec4> motion;
        for (int i = 0; i < kSize.x * kSize.y; ++i) {
            const Side& here = i % kSize.x < kEdge ? left : right;
            rgb.emplace_back(here.color);
            z.push_back(here.depth);
            motion.emplace_back(here.moved / float(kSize.x), 0, here.depth, 1);
        }
        const ivec2 size = (kSize + side - 1) / side, whole = kSize + ivec2(9, 5);
        const gpu::Image color = colors(kSize, whole, rgb), depth = depths(kSize, whole, z);
        const gpu::Image moved =
            target(vk::Format::eR32G32B32A32Sfloat, kSize, whole, motion, glm::vec4(NAN));
        const MotionBlur pass(device(), extentOf(size + 3));
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec,
                    {depth, moved, effectiveGrid(extentOf(size), extentOf(kSize), glm::vec2(side))},
                    shutter, color);
        rec.submit();
        std::vector<float> columns(kSize.x, 0.0f);  // means: taps are offset from row to row
        const auto made = readColors(color, kSize);
        for (int x = 0; x < kSize.x; ++x)
            for (int y = 0; y < kSize.y; ++y)
                columns[x] += made[std::size_t(y * kSize.x + x)].x / float(kSize.y);
        return columns;
    }
};

TEST_F(MotionBlurTest, whatDoesNotMoveStaysAsItIs) {
    for (const int side : {1, 2, 4}) {
        const auto still = run(side, {1, 3, 0}, {0, 9, 0});
        const auto shut = run(side, {1, 3, 20}, {0, 9, 20}, 0);
        for (int x = 0; x < kSize.x; ++x) {
            ASSERT_EQ(still[x] > 0.5f, x < kEdge);
            ASSERT_NEAR(std::abs(still[x] - 0.5f), 0.5, 1e-4);
            ASSERT_NEAR(shut[x], still[x], 1e-4);
        }
    }
}

TEST_F(MotionBlurTest, anEdgeThatMovesBecomesARampAsLongAsItsWay) {
    for (const int side : {1, 2}) {
        // Half of the shutter's time: 20 pixels moved leave a streak of 10.
        for (const float shutter : {1.0f, 0.5f}) {
            const float reach = 10 * shutter;
            const auto made = run(side, {1, 5, 20}, {0, 5, 20}, shutter);
            for (int x = 0; x < kSize.x; ++x) {
                const float wanted =
                    std::clamp(0.5f - (float(x) + 0.5f - kEdge) / (2 * reach), 0.0f, 1.0f);
                ASSERT_NEAR(made[x], wanted, 0.12) << side << " " << x;
            }
        }
    }
}

TEST_F(MotionBlurTest, aNearThingThatMovesBlursOverWhatIsBehindToBothSides) {
    for (const int side : {1, 2, 4}) {
        const auto made = run(side, {1, 2, 20}, {0, 9, 0});
        EXPECT_LT(made[kEdge - 3], 0.9) << side;
        EXPECT_GT(made[kEdge + 3], 0.1) << side;
        EXPECT_GT(made[kEdge - 16], 0.99) << side;
        EXPECT_LT(made[kEdge + 16], 0.01) << side;
    }
}

TEST_F(MotionBlurTest, whatMovesBehindLeavesAStillEdgeSharp) {
    for (const int side : {1, 2, 4}) {
        const auto made = run(side, {1, 2, 0}, {0, 9, 20});
        for (int x = 0; x < kEdge; ++x) ASSERT_NEAR(made[x], 1, 2e-3) << side << " " << x;
    }
}

TEST_F(MotionBlurTest, evenColorsStayEvenUpToTheEdgeOfTheLivePart) {
    for (const int side : {1, 2, 4, 8})
        for (const float moved : {3.0f, -40.0f, 500.0f})
            for (const float v : run(side, {2, 5, moved}, {2, 3, -moved}))
                ASSERT_NEAR(v, 2, 0.01) << side;
}

// In frames.

}  // namespace
}  // namespace lodestar::post

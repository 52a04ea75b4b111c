// SPDX-License-Identifier: Apache-2.0
// Depth of field alone.
#include <random>

#include <lodestar/post/dof.hpp>
#include <lodestar/post/effective.hpp>

#include "post_fixture.hpp"

namespace lodestar::post {
namespace {

using glm::ivec2;
using glm::vec3;

class DofTest : public PostTest {
protected:
    /// A picture of grid O, blurred from a grid B that sees the middle of each of its texels.
    static std::vector<vec3> run(ivec2 full, int side, const std::vector<float>& z,
                                 const std::vector<vec3>& rgb, const DofOptions& options,
                                 bool bilateral = true, float pixelAspect = 1) {
        const ivec2 size = (full + side - 1) / side, whole = full + ivec2(7, 3);
        const gpu::Image depth = depths(full, whole, z);
        const gpu::Image color = colors(full, whole, rgb);
        const Dof pass(device(), extentOf(size + 2));
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec,
                    {depth, effectiveGrid(extentOf(size), extentOf(full), glm::vec2(side)),
                     bilateral, pixelAspect},
                    options, color);
        rec.submit();
        return readColors(color, full);
    }
    static constexpr ivec2 kSize{96, 64};
    /// `left` on one half, `right` on the other, from column `middle` on.
    template <typename T>
    static std::vector<T> halves(T left, T right, int middle = kSize.x / 2) {
        std::vector<T> all;
        for (int i = 0; i < kSize.x * kSize.y; ++i)
            all.push_back(i % kSize.x < middle ? left : right);
        return all;
    }
    static std::vector<vec3> noise() {
        std::mt19937 engine(5);
        std::vector<vec3> all;
        for (int i = 0; i < kSize.x * kSize.y; ++i)
            all.emplace_back(float(engine() % 256) / 255, float(engine() % 256) / 255, 0.5f);
        return all;
    }
    static double spread(const std::vector<vec3>& rgb, int x0, int x1) {
        double sum = 0, squares = 0;
        int n = 0;
        for (int y = 12; y < kSize.y - 12; ++y)
            for (int x = x0; x < x1; ++x, ++n) {
                const double v = rgb[std::size_t(y) * kSize.x + x].x;
                sum += v;
                squares += v * v;
            }
        return squares / n - sum / n * (sum / n);
    }
    static constexpr DofOptions kLens{.focus = 5, .sharp = 0.5f, .full = 3, .radius = 0.1f};
};

TEST_F(DofTest, whatIsInFocusStaysAsItIs) {
    const auto rgb = noise();
    for (const int side : {1, 2, 4}) {
        const auto made = run(kSize, side, halves(5.0f, 5.4f), rgb, kLens);
        for (std::size_t i = 0; i < made.size(); ++i)
            ASSERT_NEAR(made[i].x, rgb[i].x, 1e-3) << side;
    }
}

TEST_F(DofTest, evenColorsStayEvenUpToTheEdgeOfTheLivePart) {
    const std::vector<vec3> grey(std::size_t(kSize.x) * kSize.y, vec3(0.5f, 2, 30));
    for (const int side : {1, 2, 4, 8})
        for (const auto& z : {halves(9.0f, 9.0f), halves(1.0f, 1.0f), halves(0.0f, 6.5f),
                              halves(2.0f, 7.0f), halves(4.1f, 0.0f)})
            for (const vec3& c : run(kSize, side, z, grey, kLens)) {
                ASSERT_NEAR(c.x, 0.5, 0.01) << side;
                ASSERT_NEAR(c.z, 30, 0.6) << side;
            }
    // Where grid B reaches past the picture.
    const ivec2 odd(93, 61);
    const auto pixels = std::size_t(odd.x) * odd.y;
    for (const int side : {2, 4, 8})
        for (const vec3& c : run(odd, side, std::vector<float>(pixels, 9.0f),
                                 std::vector<vec3>(pixels, vec3(0.5f, 2, 30)), kLens))
            ASSERT_NEAR(c.z, 30, 0.6) << side;
}

TEST_F(DofTest, bothSidesOfTheFocusBlurAndTheThesisFormulaSparesTheNearOne) {
    const auto rgb = noise();
    const double before = spread(rgb, 8, 40);
    for (const int side : {1, 2, 4}) {
        const auto made = run(kSize, side, halves(1.5f, 9.0f), rgb, kLens);
        EXPECT_LT(spread(made, 8, 36), 0.1 * before) << side;
        EXPECT_LT(spread(made, 60, 88), 0.1 * before) << side;
        DofOptions thesis = kLens;
        thesis.formula = CocFormula::thesis;
        const auto printed = run(kSize, side, halves(1.5f, 9.0f), rgb, thesis);
        for (int x = 0; x < kSize.x / 2; ++x)
            ASSERT_NEAR(printed[std::size_t(30 * kSize.x + x)].x,
                        rgb[std::size_t(30 * kSize.x + x)].x, 1e-3);
        EXPECT_LT(spread(printed, 60, 88), 0.1 * before);
    }
}

TEST_F(DofTest, blurGrowsWithTheCircleOfConfusion) {
    const auto rgb = noise();
    double last = 1;
    for (const float z : {5.2f, 6.2f, 7.0f, 8.0f}) {
        const double now = spread(run(kSize, 2, halves(z, z), rgb, kLens), 8, 88);
        EXPECT_LT(now, last) << z;
        last = now;
    }
}

TEST_F(DofTest, blursAreAsWideAsHighWhateverTheShapeOfPixels) {
    // Variances of a highlight's blur along x and y, in units of a pixel's height.
    const auto extentOfBlur = [&](int side, float pixelAspect) {
        std::vector<vec3> rgb(std::size_t(kSize.x) * kSize.y, vec3(0));
        for (int i = 0; i < 4; ++i) rgb[std::size_t(31 + i / 2) * kSize.x + 47 + i % 2] = vec3(500);
        const auto made = run(kSize, side, halves(9.0f, 9.0f), rgb, kLens, true, pixelAspect);
        glm::dvec2 squares(0);
        double sum = 0;
        for (int i = 0; i < kSize.x * kSize.y; ++i) {
            const glm::dvec2 d(i % kSize.x + 0.5 - kSize.x / 2, i / kSize.x + 0.5 - kSize.y / 2);
            squares += d * d * double(made[std::size_t(i)].x);
            sum += made[std::size_t(i)].x;
        }
        return squares / sum * glm::dvec2(pixelAspect * pixelAspect, 1);
    };
    for (const int side : {1, 2})
        for (const float pixelAspect : {0.5f, 1.0f, 2.0f}) {
            const glm::dvec2 blur = extentOfBlur(side, pixelAspect);
            EXPECT_NEAR(blur.x / blur.y, 1, 0.15) << side << " " << pixelAspect;
        }
}

TEST_F(DofTest, aHighlightOfOnePixelCountsTheSameWhereverItLies) {
    for (const int side : {1, 2, 4, 8})
        for (const ivec2 at : {ivec2(48, 32), ivec2(49, 33), ivec2(51, 34), ivec2(55, 39)}) {
            std::vector<vec3> rgb(std::size_t(kSize.x) * kSize.y, vec3(0));
            rgb[std::size_t(at.y) * kSize.x + at.x] = vec3(500);
            double sum = 0;
            for (const vec3& c : run(kSize, side, halves(9.0f, 9.0f), rgb, kLens)) sum += c.x;
            EXPECT_NEAR(sum, 500, 25) << side << " " << at.x;
        }
}

TEST_F(DofTest, whatIsOutOfFocusLosesItsEdgesAtAnyRate) {
    std::vector<vec3> rgb;
    for (const float c : halves(0.0f, 1.0f)) rgb.emplace_back(c);
    for (const int side : {1, 2, 4}) {
        const auto made = run(kSize, side, halves(6.8f, 9.0f), rgb, kLens);
        for (int x = 1; x < kSize.x; ++x) {
            const std::size_t i = std::size_t(32) * kSize.x + x;
            EXPECT_LT(made[i].x - made[i - 1].x, 0.35f) << side << " " << x;
        }
    }
}

TEST_F(DofTest, noFocusLeaksIntoTheBlurBehindIt) {
    // Sharp and white before a black wall far behind, on either side of it.
    const float sharp = 5, blurred = 12;
    for (const int middle : {kSize.x / 2, kSize.x / 2 + 1})
        for (const bool left : {true, false})
            for (const int side : {1, 2, 4}) {
                const auto z =
                    left ? halves(sharp, blurred, middle) : halves(blurred, sharp, middle);
                const auto rgb = halves(vec3(left), vec3(!left), middle);
                const auto made = run(kSize, side, z, rgb, kLens);
                for (int i = 0; i < kSize.x * kSize.y; ++i) {
                    const float v = made[std::size_t(i)].x;
                    const bool white = (i % kSize.x < middle) == left;
                    ASSERT_TRUE(white ? v == 1 : v < 0.03)
                        << side << " " << i % kSize.x << " " << v;
                }
            }
}

TEST_F(DofTest, theForegroundBleedsOverItsEdge) {
    // White and near before black in focus: its edge is soft, to both sides.
    for (const auto& [side, middle] :
         {std::pair{1, kSize.x / 2}, {2, kSize.x / 2}, {4, kSize.x / 2}, {4, kSize.x / 2 + 1}}) {
        const auto made =
            run(kSize, side, halves(1.5f, 5.0f, middle), halves(vec3(1), vec3(0), middle), kLens);
        const auto at = [&](int x) { return made[std::size_t(32 * kSize.x + x)].x; };
        EXPECT_GT(at(middle + 1), 0.25) << side;
        EXPECT_LT(at(middle - 2), 0.8) << side;
        EXPECT_GT(at(middle - 14), 0.97) << side;
        EXPECT_LT(at(middle + 14), 0.03) << side;
        for (int x = middle - 14; x < middle + 14; ++x) {
            EXPECT_LE(at(x + 1), at(x) + 0.01) << side;
            EXPECT_LT(at(x) - at(x + 1), 0.25) << side << " " << x;  // no step at the edge
        }
    }
}

TEST_F(DofTest, refusesOptionsOutOfRange) {
    const auto rgb = noise();
    const auto z = halves(1.0f, 2.0f);
    const auto with = [&](auto change) {
        DofOptions o = kLens;
        change(o);
        run(kSize, 1, z, rgb, o);
    };
    EXPECT_THROW(with([](auto& o) { o.focus = 0; }), std::invalid_argument);
    EXPECT_THROW(with([](auto& o) { o.full = o.sharp; }), std::invalid_argument);
    EXPECT_THROW(with([](auto& o) { o.radius = 0.2f; }), std::invalid_argument);
    EXPECT_THROW(with([](auto& o) { o.degree = NAN; }), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::post

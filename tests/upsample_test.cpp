// SPDX-License-Identifier: Apache-2.0
// The equation itself; upsample_gpu_test.cpp holds the shader to it.
#include <lodestar/upsample/upsample_reference.hpp>

#include <stdexcept>

#include <gtest/gtest.h>

#include "upsample_scenes.hpp"

namespace lodestar::upsample {
namespace {

constexpr glm::ivec2 kSize{33, 17};

double farthest(const std::vector<glm::dvec4>& a, const std::vector<glm::dvec4>& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 4; ++c) most = std::max(most, std::abs(a[i][c] - b[i][c]));
    return most;
}

TEST(Upsample, domainWeightsSumToOneAndAreCentred) {
    for (const Reconstruct kind : kAllKinds)
        for (int step = -40; step <= 80; ++step) {
            const double position = step / 16.0;
            const AxisTaps taps = axisTaps(kind, position);
            double sum = 0, mean = 0;
            for (int i = 0; i < 4; ++i) {
                sum += taps.weights[i];
                mean += taps.weights[i] * (taps.first + i);
                if (i >= taps.count) {
                    EXPECT_EQ(taps.weights[i], 0) << nameOf(kind);
                }
            }
            EXPECT_NEAR(sum, 1, 1e-12) << nameOf(kind) << " at " << position;
            // B-splines reproduce a line; the cut Gaussian and the nearest texel only about.
            const double slack = kind == Reconstruct::nearest    ? 0.5
                                 : kind == Reconstruct::gaussian ? 0.05
                                                                 : 1e-12;
            EXPECT_NEAR(mean, position, slack) << nameOf(kind);
        }
}

TEST(Upsample, domainWeightsAreThoseOfTheirFilters) {
    const auto weights = [](Reconstruct kind, double position) {
        return axisTaps(kind, position).weights;
    };
    using Weights = std::array<double, 4>;
    EXPECT_EQ(weights(Reconstruct::bilateral, 4.25), (Weights{0.75, 0.25}));
    EXPECT_EQ(weights(Reconstruct::biquadratic, 4), (Weights{0.125, 0.75, 0.125}));
    const Weights cubic = weights(Reconstruct::bicubic, 4);
    EXPECT_NEAR(cubic[0], 1.0 / 6, 1e-12);
    EXPECT_NEAR(cubic[1], 4.0 / 6, 1e-12);
    EXPECT_NEAR(cubic[2], 1.0 / 6, 1e-12);
    const Weights gaussian = weights(Reconstruct::gaussian, 4.5);
    EXPECT_NEAR(gaussian[1] / gaussian[0], std::exp((2.25 - 0.25) / (2 * 0.49)), 1e-9);
    EXPECT_EQ(axisTaps(Reconstruct::nearest, 4.49).first, 4);
    EXPECT_EQ(axisTaps(Reconstruct::nearest, 4.51).first, 5);
}

TEST(Upsample, constantInIsConstantOut) {
    const glm::dvec4 constant{0.25, 0.5, 2, 1};
    for (const Reconstruct kind : kAllKinds)
        for (const float rate : kRates) {
            Grids grids = noise(kSize, rate, 7);
            for (ReferenceTexel& texel : grids.coarse) texel.terms = constant;
            for (const glm::dvec4& value : grids.reference(kind, {0.02f, 0.4f}))
                for (int c = 0; c < 4; ++c)
                    EXPECT_NEAR(value[c], constant[c], 1e-9) << nameOf(kind) << " r=" << rate;
        }
}

TEST(Upsample, rateOneIsTheIdentityForTheTent) {
    Grids grids = noise(kSize, 1, 3);
    for (const Reconstruct kind : {Reconstruct::bilateral, Reconstruct::bilinear}) {
        const auto values = grids.reference(kind, {0.02f, 0.4f});
        for (std::size_t i = 0; i < values.size(); ++i)
            EXPECT_EQ(values[i], grids.coarse[i].terms) << nameOf(kind);
    }
}

TEST(Upsample, infiniteSigmasAreBilinear) {
    for (const float rate : kRates) {
        const Grids grids = noise(kSize, rate, 11);
        EXPECT_EQ(grids.reference(Reconstruct::bilateral, {kInfinity, kInfinity}),
                  grids.reference(Reconstruct::bilinear, {0.02f, 0.4f}));
    }
}

TEST(Upsample, onAPlaneFacingTheEyeFiniteSigmasAreBilinear) {
    for (const float rate : kRates) {
        Grids grids = noise(kSize, rate, 13);
        for (ReferenceTexel& texel : grids.coarse) texel.depth = 4, texel.normal = {0, 0};
        for (ReferencePixel& pixel : grids.pixels) pixel = {4, {0, 0, 1}};
        EXPECT_LT(farthest(grids.reference(Reconstruct::bilateral, {0.001f, 0.01f}),
                           grids.reference(Reconstruct::bilinear, {})),
                  1e-12);
    }
}

// The convention of the grids: texel j of S covers the O pixels j·r … (j+1)·r. A shift of half a
// texel, or anchoring at corners, would show here as a constant error.
TEST(Upsample, rampSampledAtTexelCentresIsExactInTheInterior) {
    for (const float rate : kRates)
        for (const Reconstruct kind : kAllKinds) {
            if (kind == Reconstruct::nearest || kind == Reconstruct::gaussian) continue;
            Grids grids({64, 48}, rate, [](glm::dvec2 at) -> Surfel {
                return {{at.x / 64, at.y / 48, (at.x + at.y) / 112, 1}, 4, {0, 0, 1}};
            });
            // Unrounded, so that what is left is the filter's own error.
            for (int y = 0; y < grids.coarseSize.y; ++y)
                for (int x = 0; x < grids.coarseSize.x; ++x) {
                    const glm::dvec2 at = grids.rate * glm::dvec2(x + 0.5, y + 0.5);
                    grids.coarse[std::size_t(y * grids.coarseSize.x + x)].terms = {at.x, at.y, 0,
                                                                                   0};
                }
            const auto values = grids.reference(kind, {});
            const int border = int(std::ceil(2 * rate));
            int checked = 0;
            for (int y = border; y < 48 - border; ++y)
                for (int x = border; x < 64 - border; ++x, ++checked) {
                    const glm::dvec4& value = values[grids.indexOf(x, y)];
                    ASSERT_NEAR(value.x, x + 0.5, 1e-9) << nameOf(kind) << " r=" << rate;
                    ASSERT_NEAR(value.y, y + 0.5, 1e-9) << nameOf(kind) << " r=" << rate;
                }
            EXPECT_GT(checked, 500);
        }
}

TEST(Upsample, guidedKindsDoNotLeakAcrossADepthEdgeAndBilinearDoes) {
    for (const float rate : {2.0f, 3.5f, 7.3f}) {
        // An edge off the borders of the texels: every texel lies on one side of it.
        const double column = std::round(16 / rate) * rate + 0.3 * rate;
        const Grids grids = depthEdge({48, 20}, rate, column);
        const auto worst = [&](Reconstruct kind) {
            const auto values = grids.reference(kind, {0.02f, 0.4f});
            double most = 0;
            for (int x = 0; x < 48; ++x)
                most = std::max(most, std::abs(values[grids.indexOf(x, 10)].x -
                                               (x + 0.5 > column ? 1.0 : 0.0)));
            return most;
        };
        for (const Reconstruct kind : {Reconstruct::bilateral, Reconstruct::biquadratic,
                                       Reconstruct::bicubic, Reconstruct::gaussian})
            EXPECT_LT(worst(kind), 1e-3) << nameOf(kind) << " r=" << rate;
        EXPECT_GT(worst(Reconstruct::bilinear), 0.2) << "r=" << rate;
    }
}

TEST(Upsample, normalsSeparateWhatDepthDoesNot) {
    const Grids grids({32, 8}, 4, [](glm::dvec2 at) -> Surfel {
        const double tilt = at.x > 17 ? 1.1 : 0;
        return {glm::dvec4(at.x > 17 ? 1 : 0), 5, {std::sin(tilt), 0, std::cos(tilt)}};
    });
    const std::size_t left = grids.indexOf(16, 4);
    EXPECT_LT(grids.reference(Reconstruct::bilateral, {kInfinity, 0.4f})[left].x, 1e-3);
    EXPECT_GT(grids.reference(Reconstruct::bilateral, {0.02f, kInfinity})[left].x, 0.1);
}

TEST(Upsample, aPixelUnlikeAllTapsTakesTheMostSimilar) {
    Grids grids = depthEdge({16, 16}, 4, 8);
    ReferencePixel& odd = grids.pixels[grids.indexOf(7, 7)];  // between all four texels
    odd.depth = 40;
    EXPECT_NEAR(grids.reference(Reconstruct::bilateral, {0.001f, 0.4f})[grids.indexOf(7, 7)].x, 1,
                1e-9);
    odd.depth = 0.1;
    EXPECT_NEAR(grids.reference(Reconstruct::bilateral, {0.001f, 0.4f})[grids.indexOf(7, 7)].x, 0,
                1e-9);
}

TEST(Upsample, referenceRefusesWhatTheEquationHasNoMeaningFor) {
    const Grids grids = noise(kSize, 2, 1);
    const auto run = [&](Sigmas sigmas, double rate, glm::ivec2 size) {
        upsampleReference(Reconstruct::bilateral, sigmas,
                          {grids.coarse, grids.pixels, grids.coarseSize, size, rate});
    };
    EXPECT_NO_THROW(run({}, 2, kSize));
    EXPECT_THROW(run({0, 1}, 2, kSize), std::invalid_argument);
    EXPECT_THROW(run({1, -1}, 2, kSize), std::invalid_argument);
    EXPECT_THROW(run({}, 0.99, kSize), std::invalid_argument);
    EXPECT_THROW(run({}, std::nan(""), kSize), std::invalid_argument);
    EXPECT_THROW(run({}, 2, {32, 17}), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::upsample

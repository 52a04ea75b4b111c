// SPDX-License-Identifier: Apache-2.0
// Local rates of grid S, and supersampling on top of coarse terms.
#include <cmath>

#include <lodestar/quality/metrics.hpp>

#include <lodestar/upsample/refine_params.h>

#include "fence_frames.hpp"

namespace lodestar::frame {
namespace {

constexpr FrameSettings kSmall{.size = {160, 96}, .shadowMapSize = 512};

class LocalRateTest : public GpuTest {};

std::uint32_t texelsBetween(vk::Extent2D size, float rate) {
    const vk::Extent2D s = shading::coarseExtent(size, rate);
    return s.width * s.height - (s.width + 1) / 2 * ((s.height + 1) / 2);
}

TEST_F(LocalRateTest, evaluatesFewerTexelsAndHardlyChangesTheTerms) {
    Rig rig(device(), kSmall);
    const auto full = rig.terms({});
    for (const float rate : {1.5f, 2.0f}) {
        const auto everywhere = rig.terms({.shadingRate = rate});
        EXPECT_EQ(rig.frame.refinedTexels(), 0u);
        const auto local = rig.terms({.shadingRate = rate, .localRate = 0.03f});
        const std::uint32_t refined = rig.frame.refinedTexels();
        EXPECT_GT(refined, 20u) << "shadow edges are evaluated";
        EXPECT_LT(refined, texelsBetween(kSmall.size, rate) / 2) << "what is flat is not";
        const auto twice = rig.terms({.shadingRate = 2 * rate});
        EXPECT_LT(errorOf(full, local), 1.1 * errorOf(full, everywhere)) << rate;
        EXPECT_LT(errorOf(full, local), 0.7 * errorOf(full, twice)) << rate;
    }
}

TEST_F(LocalRateTest, spreadThatNothingMeetsEvaluatesAllAndEqualsOneRate) {
    // Noise on every surface: no two neighbours have the same terms.
    FrameSettings settings = kSmall;
    settings.noiseOctaves = 6;
    settings.noiseScale = 0.3f;
    Rig rig(device(), settings);
    const auto everywhere = rig.terms({.shadingRate = 2.5f});
    const auto local = rig.terms({.shadingRate = 2.5f, .localRate = 1e-6f});
    std::size_t different = 0;
    for (std::size_t i = 0; i < local.size(); ++i) {
        if (everywhere[i] == glm::vec4(1, 1, 0.5f, 0)) continue;  // background: terms of nothing
        different += glm::distance(local[i], everywhere[i]) > 2e-3f;
    }
    EXPECT_LE(different, local.size() / 100) << "at the rim of the background at most";
}

TEST_F(LocalRateTest, largerSpreadEvaluatesLess) {
    Rig rig(device(), kSmall);
    std::uint32_t before = ~0u;
    for (const float spread : {0.005f, 0.05f, 0.5f}) {
        rig.terms({.shadingRate = 2, .localRate = spread});
        EXPECT_LT(rig.frame.refinedTexels(), before);
        before = rig.frame.refinedTexels();
    }
}

TEST_F(LocalRateTest, choiceIsReproducible) {
    Rig rig(device(), kSmall);
    const Levers levers{.shadingRate = 2.3f, .repair = 0.05f, .localRate = 0.03f};
    const auto first = rig.terms(levers);
    EXPECT_EQ(rig.terms(levers), first);
}

TEST_F(LocalRateTest, refineRefusesWhatMakesNoSense) {
    const gpu::TexelList list(device(), {8, 8}, "list");
    const upsample::Refine refine(device());
    const gpu::Image image(device(), {.name = "any",
                                      .format = vk::Format::eR32Sfloat,
                                      .extent = {8, 8},
                                      .usage = vk::ImageUsageFlagBits::eSampled});
    gpu::Recorder rec(device());
    const auto record = [&](vk::Extent2D size, float rate, float spread) {
        refine.record(rec, {image, image, size, rate}, {}, spread, image, list);
    };
    EXPECT_THROW(record({9, 8}, 2, 0.1f), std::invalid_argument);
    EXPECT_THROW(record({8, 8}, 0.5f, 0.1f), std::invalid_argument);
    EXPECT_THROW(record({8, 8}, 2, 0), std::invalid_argument);
    EXPECT_THROW(gpu::TexelList(device(), {70000, 1}, "list"), std::invalid_argument);
}

TEST_F(LocalRateTest, papersPackingLosesALittleAndNoMore) {
    FrameSettings settings = kSmall;
    Rig rig(device(), settings);
    settings.packing = upsample::Packing::yang;
    Rig packed(device(), settings);
    const auto halves = rig.terms({.shadingRate = 2}), bytes = packed.terms({.shadingRate = 2});
    EXPECT_NE(halves, bytes);
    // Half a step of 8 bits, but for the few pixels whose weights turn on a step of the normal.
    std::size_t off = 0;
    for (std::size_t i = 0; i < halves.size(); ++i)
        off += std::abs(halves[i].x - bytes[i].x) > 0.004f;
    EXPECT_LT(off, halves.size() / 20);
    // Radiance too.
    const Levers whole{.shadingRate = 2, .resizeAll = true};
    rig.frame.render(kView, whole);
    packed.frame.render(kView, whole);
    const auto a = gpu::as<std::uint64_t>(gpu::readImage(device(), rig.frame.radiance()));
    const auto b = gpu::as<std::uint64_t>(gpu::readImage(device(), packed.frame.radiance()));
    off = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const float x = glm::unpackHalf4x16(a[i]).y, y = glm::unpackHalf4x16(b[i]).y;
        off += std::abs(x - y) > 0.02f * (0.1f + x);
    }
    EXPECT_LT(off, a.size() / 20);
}

class SupersampleTest : public GpuTest {
protected:
    static quality::RgbImage picture(std::uint32_t supersample, post::ReduceFilter filter,
                                     const Levers& levers = {}) {
        FrameSettings settings = kSmall;
        settings.supersample = supersample;
        settings.reduce = filter;
        Rig rig(device(), settings);
        rig.frame.render(kView, levers);
        const auto rgba = gpu::readImage(device(), rig.frame.display());
        const vk::Extent2D size = rig.frame.display().extent();
        EXPECT_EQ(size, kSmall.size);
        quality::RgbImage image(int(size.width), int(size.height));
        for (std::size_t i = 0; i < rgba.size() / 4; ++i)
            for (std::size_t c = 0; c < 3; ++c)
                image.rgb[3 * i + c] = static_cast<std::uint8_t>(rgba[4 * i + c]);
        return image;
    }
};

TEST_F(SupersampleTest, pictureIsNearerToOneOfManySamples) {
    const auto box = post::ReduceFilter::box;
    const auto many = picture(4, box);
    const double one = quality::psnr(many, picture(1, box));
    const double four = quality::psnr(many, picture(2, box));
    EXPECT_GT(four, one + 4);
    EXPECT_GT(quality::psnr(many, picture(2, post::ReduceFilter::mitchell)), one + 2);
}

TEST_F(SupersampleTest, expensiveTermsAreEvaluatedNoMoreOften) {
    FrameSettings settings = kSmall;
    settings.supersample = 2;
    Rig rig(device(), settings);
    rig.frame.render(kView, {.localRate = 0.5f});
    // Grid S of r = 1 has the size of the picture, not of O.
    EXPECT_LT(rig.frame.refinedTexels(), kSmall.size.width * kSmall.size.height);
    EXPECT_GT(rig.frame.refinedTexels(), 0u) << "O is twice as fine as S: there is a grid S";
    EXPECT_EQ(rig.frame.settings().size, (vk::Extent2D{320, 192}));
}

TEST_F(SupersampleTest, settingsOutOfRangeAreRefused) {
    FrameSettings settings = kSmall;
    settings.supersample = 5;
    EXPECT_THROW(Rig(device(), settings), std::invalid_argument);
    settings.supersample = 2;
    settings.showLods = true;
    EXPECT_THROW(Rig(device(), settings), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::frame

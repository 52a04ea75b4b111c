// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/readback.hpp>
#include <lodestar/upsample/pack_coarse.hpp>
#include <lodestar/upsample/upsample.hpp>

#include "gpu_device.hpp"
#include "upsample_scenes.hpp"

namespace lodestar::upsample {
namespace {

using Usage = vk::ImageUsageFlagBits;

class UpsampleGpu : public GpuTest {
protected:
    template <typename T>
    static gpu::Image image(const char* name, vk::Format format, glm::ivec2 size,
                            const std::vector<T>& texels) {
        gpu::Image made(device(), {.name = name,
                                   .format = format,
                                   .extent = {std::uint32_t(size.x), std::uint32_t(size.y)},
                                   .usage = Usage::eSampled | Usage::eStorage |
                                            Usage::eTransferDst | Usage::eTransferSrc});
        gpu::uploadImage(device(), made, 0, std::as_bytes(std::span(texels)));
        return made;
    }

    /// The texels of S as coarse_texel.glsl packs them.
    static std::vector<glm::uvec4> packed(const Grids& grids) {
        std::vector<glm::uvec4> texels;
        for (const ReferenceTexel& t : grids.coarse) {
            const glm::vec4 terms(t.terms);
            texels.push_back(
                {glm::packHalf2x16({terms.x, terms.y}), glm::packHalf2x16({terms.z, terms.w}),
                 glm::floatBitsToUint(float(t.depth)), glm::packHalf2x16(glm::vec2(t.normal))});
        }
        return texels;
    }

    static std::vector<glm::vec4> run(const Upsample& pass, const Grids& grids,
                                      const Sigmas& sigmas) {
        std::vector<float> depths;
        std::vector<std::uint32_t> normals;
        for (const ReferencePixel& p : grids.pixels) {
            depths.push_back(float(p.depth));
            normals.push_back(shared::packNormal(glm::vec3(p.normal)));
        }
        const gpu::Image coarse =
            image("coarse", vk::Format::eR32G32B32A32Uint, grids.coarseSize, packed(grids));
        const gpu::Image depth = image("depth", vk::Format::eR32Sfloat, grids.fullSize, depths);
        const gpu::Image normal = image("normal", vk::Format::eR32Uint, grids.fullSize, normals);
        const gpu::Image terms = image("terms", vk::Format::eR16G16B16A16Sfloat, grids.fullSize,
                                       std::vector<std::uint64_t>(depths.size()));
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec, {coarse, depth, normal, coarse.extent(), static_cast<float>(grids.rate)},
                    sigmas, terms);
        rec.submit();
        std::vector<glm::vec4> values;
        for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device(), terms)))
            values.push_back(glm::unpackHalf4x16(bits));
        return values;
    }
};

TEST_F(UpsampleGpu, packedTexelsHoldWhatTheyWereGiven) {
    const glm::ivec2 size(17, 9);
    std::vector<std::uint64_t> terms;
    std::vector<float> depths;
    std::vector<std::uint32_t> normals;
    for (int i = 0; i < size.x * size.y; ++i) {
        const float t = float(i) / 160;
        terms.push_back(glm::packHalf4x16({t, 1 - t, 3 * t, -t}));
        depths.push_back(i % 5 == 0 ? 0 : 1 + t);
        normals.push_back(shared::packNormal(glm::normalize(glm::vec3(t, 0.3f, 1))));
    }
    const gpu::Image coarse =
        image("coarse", vk::Format::eR32G32B32A32Uint, size, std::vector<glm::uvec4>(terms.size()));
    const gpu::Image term = image("terms", vk::Format::eR16G16B16A16Sfloat, size, terms);
    const gpu::Image depth = image("depth", vk::Format::eR32Sfloat, size, depths);
    const gpu::Image normal = image("normal", vk::Format::eR32Uint, size, normals);
    const PackCoarse pass(device());
    gpu::Recorder rec(device());
    rec.begin();
    pass.record(rec, {term, depth, normal}, coarse);
    rec.submit();
    const auto texels = gpu::as<glm::uvec4>(gpu::readImage(device(), coarse));
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const glm::vec4 given = glm::unpackHalf4x16(terms[i]);
        EXPECT_EQ(glm::unpackHalf2x16(texels[i].x), glm::vec2(given.x, given.y));
        EXPECT_EQ(glm::unpackHalf2x16(texels[i].y), glm::vec2(given.z, given.w));
        EXPECT_EQ(glm::uintBitsToFloat(texels[i].z), depths[i]);
        const glm::vec3 n = depths[i] > 0 ? shared::unpackNormal(normals[i]) : glm::vec3(0, 0, 1);
        EXPECT_NEAR(glm::unpackHalf2x16(texels[i].w).x, n.x / n.z, 2e-3f);
        EXPECT_NEAR(glm::unpackHalf2x16(texels[i].w).y, n.y / n.z, 2e-3f);
    }
}

// The results are halves: 2⁻¹¹ of a value up to 1. The rest is for positions and exponents in
// single precision.
constexpr double kTolerance = 1.0 / 2048 + 3e-4;

/// On the border between two texels either is the nearest.
bool onBorder(const Grids& grids, std::size_t i) {
    const glm::dvec2 pixel(i % std::size_t(grids.fullSize.x), i / std::size_t(grids.fullSize.x));
    const glm::dvec2 at = (pixel + 0.5) / grids.rate;
    const glm::dvec2 off = glm::abs(at - glm::round(at));
    return std::min(off.x, off.y) < 1e-4;
}

TEST_F(UpsampleGpu, everyKindIsTheReference) {
    for (const Reconstruct kind : kAllKinds) {
        const Upsample pass(device(), kind);
        for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(17, 33), glm::ivec2(64, 48)})
            for (const float rate : kRates) {
                const Grids grids = noise(size, rate, 21);
                const Sigmas sigmas{0.02f, 0.6f};
                const auto values = run(pass, grids, sigmas);
                const auto expected = grids.reference(kind, sigmas);
                for (std::size_t i = 0; i < values.size(); ++i) {
                    if (kind == Reconstruct::nearest && onBorder(grids, i)) continue;
                    for (int c = 0; c < 4; ++c)
                        ASSERT_NEAR(values[i][c], expected[i][c], kTolerance)
                            << nameOf(kind) << ' ' << size.x << 'x' << size.y << " r=" << rate
                            << " pixel " << i << " channel " << c;
                }
            }
    }
}

TEST_F(UpsampleGpu, infiniteSigmasAreBilinearBitForBit) {
    const Upsample bilateral(device(), Reconstruct::bilateral);
    const Upsample bilinear(device(), Reconstruct::bilinear);
    for (const float rate : kRates) {
        const Grids grids = noise({33, 17}, rate, 22);
        EXPECT_EQ(run(bilateral, grids, {kInfinity, kInfinity}), run(bilinear, grids, {}));
    }
}

TEST_F(UpsampleGpu, rateOneIsTheIdentityForTheTent) {
    const Grids grids = noise({17, 9}, 1, 23);
    for (const Reconstruct kind : {Reconstruct::bilateral, Reconstruct::bilinear}) {
        const auto values = run(Upsample(device(), kind), grids, {0.02f, 0.4f});
        for (std::size_t i = 0; i < values.size(); ++i)
            EXPECT_EQ(values[i], glm::vec4(grids.coarse[i].terms)) << nameOf(kind);
    }
}

TEST_F(UpsampleGpu, rampSampledAtTexelCentresIsExactInTheInterior) {
    const Upsample pass(device(), Reconstruct::bilateral);
    for (const float rate : kRates) {
        const Grids grids({64, 48}, rate, [](glm::dvec2 at) -> Surfel {
            return {{at.x / 64, at.y / 48, 0, 1}, 4, {0, 0, 1}};
        });
        const auto values = run(pass, grids, {});
        const int border = int(std::ceil(rate));
        for (int y = border; y < 48 - border; ++y)
            for (int x = border; x < 64 - border; ++x) {
                const glm::vec4 value = values[grids.indexOf(x, y)];
                ASSERT_NEAR(value.x, (x + 0.5) / 64, 1.0 / 2048) << "r=" << rate;
                ASSERT_NEAR(value.y, (y + 0.5) / 48, 1.0 / 2048) << "r=" << rate;
            }
    }
}

TEST_F(UpsampleGpu, guidedDoesNotLeakAcrossADepthEdgeAndBilinearDoes) {
    const double column = 18.1;
    const Grids grids = depthEdge({48, 20}, 3.5f, column);
    const auto worst = [&](Reconstruct kind) {
        const auto values = run(Upsample(device(), kind), grids, {0.02f, 0.4f});
        double most = 0;
        for (int x = 0; x < 48; ++x)
            most = std::max(most, std::abs(double(values[grids.indexOf(x, 10)].x) -
                                           (x + 0.5 > column ? 1.0 : 0.0)));
        return most;
    };
    EXPECT_LT(worst(Reconstruct::bilateral), 1e-3);
    EXPECT_GT(worst(Reconstruct::bilinear), 0.2);
}

// Depths that no range filter was meant for: far beyond what exp2 can hold, and a tap of almost no
// domain weight that alone is like the pixel.
TEST_F(UpsampleGpu, pixelsUnlikeAllTapsStayFinite) {
    for (const Reconstruct kind : kAllKinds) {
        const Upsample pass(device(), kind);
        for (const float rate : {1.0f, 2.0f, 3.5f}) {
            Grids grids = noise({32, 32}, rate, 24);
            constexpr double kStrange[] = {1e-30, 1e-4, 3, 5e4, 1e30};
            for (std::size_t i = 0; i < grids.pixels.size(); ++i)
                grids.pixels[i].depth = kStrange[i % std::size(kStrange)];
            for (std::size_t i = 0; i < grids.coarse.size(); ++i)
                grids.coarse[i].depth = i % 3 == 0 ? 3 : 5;
            for (const glm::vec4& value : run(pass, grids, {1e-4f, 1e-3f}))
                for (int c = 0; c < 4; ++c) {
                    ASSERT_TRUE(std::isfinite(value[c])) << nameOf(kind) << " r=" << rate;
                    ASSERT_LE(std::abs(value[c] - 0.5), 0.5) << nameOf(kind) << " r=" << rate;
                }
        }
    }
}

TEST_F(UpsampleGpu, refusesRatesSigmasAndSizesOutOfRange) {
    const Upsample pass(device(), Reconstruct::bilateral);
    const Grids grids = noise({8, 8}, 2, 25);
    const auto withRate = [&](double rate) {
        Grids changed = grids;
        changed.rate = rate;
        run(pass, changed, {});
    };
    EXPECT_THROW(withRate(0.99), std::invalid_argument);
    EXPECT_THROW(withRate(-1), std::invalid_argument);
    EXPECT_THROW(withRate(std::nan("")), std::invalid_argument);
    for (const float bad : {0.0f, -1.0f, std::nanf("")}) {
        EXPECT_THROW(run(pass, grids, {bad, 1}), std::invalid_argument);
        EXPECT_THROW(run(pass, grids, {1, bad}), std::invalid_argument);
    }
    const gpu::Image any =
        image("any", vk::Format::eR32Uint, {4, 4}, std::vector<std::uint32_t>(16));
    gpu::Recorder rec(device());
    rec.begin();
    EXPECT_THROW(pass.record(rec, {any, any, any, {5, 4}, 2}, {}, any), std::invalid_argument);
    EXPECT_THROW(pass.record(rec, {any, any, any, {0, 4}, 2}, {}, any), std::invalid_argument);
    rec.submit();
}

}  // namespace
}  // namespace lodestar::upsample

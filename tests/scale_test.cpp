// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <random>

#include <glm/gtc/packing.hpp>

#include <lodestar/gpu/readback.hpp>
#include <lodestar/scale/spatial.hpp>
#include <lodestar/scale/spatial_reference.hpp>

#include "gpu_device.hpp"

namespace lodestar::scale {
namespace {

using glm::ivec2;
using reference::Picture;
using Usage = vk::ImageUsageFlagBits;

constexpr std::array kAll{Filter::point, Filter::bilinear,    Filter::bicubic,
                          Filter::noise, Filter::noiseOffset, Filter::edgeAdaptive};

vk::Extent2D extentOf(ivec2 size) {
    return {std::uint32_t(size.x), std::uint32_t(size.y)};
}

class ScaleTest : public GpuTest {
protected:
    static gpu::Image image(vk::Format format, ivec2 size) {
        return {device(),
                {.name = "picture",
                 .format = format,
                 .extent = extentOf(size),
                 .usage = Usage::eSampled | Usage::eStorage | Usage::eTransferDst |
                          Usage::eTransferSrc}};
    }

    /// `live` in the corner of a half-float target that holds NaN everywhere else.
    static gpu::Image target(const Picture& live, ivec2 whole) {
        std::vector<std::uint64_t> texels(std::size_t(whole.x) * whole.y,
                                          glm::packHalf4x16(glm::vec4(NAN)));
        for (int y = 0; y < live.size.y; ++y)
            for (int x = 0; x < live.size.x; ++x)
                texels[std::size_t(y) * whole.x + x] =
                    glm::packHalf4x16(glm::vec4(live.at({x, y}), 1));
        gpu::Image made = image(vk::Format::eR16G16B16A16Sfloat, whole);
        gpu::uploadImage(device(), made, 0, std::as_bytes(std::span(texels)));
        return made;
    }

    static std::vector<glm::u8vec4> run(const Spatial& pass, const gpu::Image& source, ivec2 live,
                                        ivec2 size, const SpatialOptions& options) {
        const gpu::Image out = image(vk::Format::eR8G8B8A8Unorm, size);
        gpu::Recorder rec(device());
        rec.begin();
        pass.record(rec, source, extentOf(live), options, out);
        rec.submit();
        return gpu::as<glm::u8vec4>(gpu::readImage(device(), out));
    }

    static Picture random(ivec2 size, unsigned seed) {
        std::mt19937 engine(seed);
        std::uniform_real_distribution<float> value(0, 1);
        Picture picture{size, {}};
        for (int i = 0; i < size.x * size.y; ++i)
            picture.texels.push_back(glm::unpackHalf4x16(
                glm::packHalf4x16({value(engine), value(engine), value(engine), 1})));
        return picture;
    }
};

TEST_F(ScaleTest, equalsTheReference) {
    const Spatial pass(device());
    for (const Filter filter :
         {Filter::point, Filter::bilinear, Filter::bicubic, Filter::edgeAdaptive})
        for (const auto& [live, size] : {std::pair{ivec2(17, 33), ivec2(40, 51)},
                                         {ivec2(1, 1), ivec2(3, 5)},
                                         {ivec2(20, 9), ivec2(28, 13)},
                                         {ivec2(5, 64), ivec2(7, 65)},
                                         {ivec2(21, 30), ivec2(40, 30)},
                                         {ivec2(40, 15), ivec2(31, 30)}}) {
            const Picture source = random(live, 7);
            const Picture wanted = reference::scale(source, size, filter);
            const auto made = run(pass, target(source, live), live, size, {.filter = filter});
            int worst = 0;
            for (std::size_t i = 0; i < made.size(); ++i)
                for (int c = 0; c < 3; ++c)
                    if (std::abs(int(made[i][c]) - int(std::lround(255 * wanted.texels[i][c]))) > 3)
                        printf("%d %d, %d %d (%f)\n", int(i) % size.x, int(i) / size.x, made[i][c],
                               int(std::lround(255 * wanted.texels[i][c])), 0.0),
                            worst = std::max(worst,
                                             std::abs(int(made[i][c]) -
                                                      int(std::lround(255 * wanted.texels[i][c]))));
            // Samplers place a sample to 1/256 texel; a place may round to either side of a texel.
            EXPECT_LE(worst, 3) << kFilterNames[std::size_t(filter)] << " " << size.x;
        }
}

TEST_F(ScaleTest, neverReadsOutsideTheLivePart) {
    const Spatial pass(device());
    const ivec2 live(13, 21);
    Picture grey{live, std::vector<glm::dvec3>(13 * 21, glm::dvec3(0.5))};
    for (const Filter filter : kAll)
        for (const ivec2 whole : {live, ivec2(14, 22), ivec2(40, 40), ivec2(13, 64)})
            for (const ivec2 size : {ivec2(26, 42), ivec2(31, 29), live, ivec2(6, 10)}) {
                const auto made = run(pass, target(grey, whole), live, size,
                                      {.filter = filter, .grain = 0, .offset = 1, .seed = 3});
                for (const glm::u8vec4 texel : made) {
                    ASSERT_NEAR(texel.x, 128, 1) << kFilterNames[std::size_t(filter)];
                    ASSERT_EQ(texel.x, texel.z);
                }
            }
    // A live part one texel wide has no texel to blend with.
    Picture dot{{1, 1}, {glm::dvec3(1)}};
    for (const Filter filter : kAll)
        for (const glm::u8vec4 texel : run(pass, target(dot, {3, 3}), {1, 1}, {4, 4},
                                           {.filter = filter, .grain = 0, .offset = 1}))
            ASSERT_EQ(texel.y, 255) << kFilterNames[std::size_t(filter)];
}

TEST_F(ScaleTest, aPictureOfTheSameSizeStaysAsItIs) {
    const Spatial pass(device());
    const ivec2 size(19, 11);
    const Picture source = random(size, 3);
    for (const Filter filter :
         {Filter::point, Filter::bilinear, Filter::bicubic, Filter::edgeAdaptive}) {
        const auto made = run(pass, target(source, size), size, size, {.filter = filter});
        for (std::size_t i = 0; i < made.size(); ++i)
            ASSERT_NEAR(made[i].x, 255 * source.texels[i].x, 1)
                << kFilterNames[std::size_t(filter)];
    }
}

TEST_F(ScaleTest, anAxisOfTheSameSizeStaysAsItIs) {
    const Spatial pass(device());
    Picture rows = random({10, 31}, 9), columns = random({31, 10}, 9);
    for (int i = 0; i < 310; ++i) {
        rows.texels[std::size_t(i)] = rows.at({0, i / 10});
        columns.texels[std::size_t(i)] = columns.at({i % 31, 0});
    }
    for (const Filter filter :
         {Filter::point, Filter::bilinear, Filter::bicubic, Filter::edgeAdaptive}) {
        const auto wide = run(pass, target(rows, {12, 40}), {10, 31}, {20, 31}, {.filter = filter});
        const auto high =
            run(pass, target(columns, {40, 12}), {31, 10}, {31, 20}, {.filter = filter});
        for (int i = 0; i < 20 * 31; ++i) {
            ASSERT_NEAR(wide[std::size_t(i)].y, 255 * rows.at({0, i / 20}).y, 1)
                << kFilterNames[std::size_t(filter)];
            ASSERT_NEAR(high[std::size_t(i)].y, 255 * columns.at({i % 31, 0}).y, 1)
                << kFilterNames[std::size_t(filter)];
        }
    }
}

/// A slanted edge, black over white, as point sampling draws it.
Picture slantedEdge(ivec2 size) {
    Picture picture{size, {}};
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) / glm::dvec2(size);
            picture.texels.emplace_back(at.y > 0.3 + 0.27 * at.x ? 0.9 : 0.1);
        }
    return picture;
}

TEST_F(ScaleTest, edgeAdaptiveDrawsSlantedEdgesBetter) {
    const Spatial pass(device());
    const ivec2 live(40, 40), size(80, 80);
    const Picture wanted = slantedEdge(size);
    const auto errorOf = [&](Filter filter) {
        const auto made =
            run(pass, target(slantedEdge(live), live), live, size, {.filter = filter});
        double sum = 0;
        for (std::size_t i = 0; i < made.size(); ++i)
            sum += std::pow(made[i].x / 255.0 - wanted.texels[i].x, 2);
        return sum;
    };
    const double ours = errorOf(Filter::edgeAdaptive);
    EXPECT_LT(ours, 0.95 * errorOf(Filter::bilinear));
    EXPECT_LT(ours, 0.95 * errorOf(Filter::bicubic));
}

TEST_F(ScaleTest, edgeAdaptiveNeverRings) {
    const Spatial pass(device());
    const ivec2 live(16, 16);
    for (const glm::u8vec4 texel : run(pass, target(slantedEdge(live), live), live, {45, 37}, {})) {
        ASSERT_GE(texel.x, std::floor(0.1 * 255));
        ASSERT_LE(texel.x, std::ceil(0.9 * 255));
    }
}

TEST_F(ScaleTest, noiseIsAsStrongAsAskedAndTheSameForTheSameSeed) {
    const Spatial pass(device());
    const ivec2 live(32, 32), size(64, 64);
    Picture grey{live, std::vector<glm::dvec3>(32 * 32, glm::dvec3(0.5))};
    const gpu::Image source = target(grey, live);
    const auto noisy = [&](std::uint32_t seed) {
        return run(pass, source, live, size,
                   {.filter = Filter::noise, .grain = 0.1f, .seed = seed});
    };
    const auto made = noisy(1);
    int low = 255, high = 0;
    double mean = 0;
    for (const glm::u8vec4 texel : made) {
        low = std::min<int>(low, texel.x);
        high = std::max<int>(high, texel.x);
        mean += texel.x / double(made.size());
    }
    EXPECT_NEAR(low, 0.4 * 255, 2);
    EXPECT_NEAR(high, 0.6 * 255, 2);
    EXPECT_NEAR(mean, 127.5, 1);
    EXPECT_EQ(made, noisy(1));
    EXPECT_NE(made, noisy(2));
}

TEST_F(ScaleTest, noiseOffsetMovesPlacesAndNotColours) {
    const Spatial pass(device());
    const ivec2 live(20, 20), size(40, 40);
    const gpu::Image source = target(slantedEdge(live), live);
    const auto plain = run(pass, source, live, size, {.filter = Filter::bilinear});
    const auto moved = run(pass, source, live, size, {.filter = Filter::noiseOffset});
    int changed = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
        ASSERT_GE(moved[i].x, 25);
        ASSERT_LE(moved[i].x, 230);
        changed += std::abs(int(plain[i].x) - moved[i].x) > 8;
    }
    EXPECT_GT(changed, 40);
    EXPECT_LT(changed, 400);  // along the edge alone
}

TEST_F(ScaleTest, refusesWhatMakesNoSense) {
    const Spatial pass(device());
    const gpu::Image source = image(vk::Format::eR8G8B8A8Unorm, {8, 8});
    gpu::Recorder rec(device());
    rec.begin();
    EXPECT_THROW(pass.record(rec, source, {0, 4}, {}, source), std::invalid_argument);
    EXPECT_THROW(pass.record(rec, source, {4, 9}, {}, source), std::invalid_argument);
    EXPECT_THROW(pass.record(rec, source, {4, 4}, {.grain = 2}, source), std::invalid_argument);
    EXPECT_THROW(pass.record(rec, source, {4, 4}, {.offset = NAN}, source), std::invalid_argument);
    rec.submit();
}

}  // namespace
}  // namespace lodestar::scale

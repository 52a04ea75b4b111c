// SPDX-License-Identifier: Apache-2.0
// Pictures joined over time.
#include <map>

#include <glm/gtc/packing.hpp>

#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>
#include <lodestar/scene/procedural.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {
namespace {

using scale::TemporalMode;
using scene::Camera;

constexpr vk::Extent2D kSize{96, 64};
constexpr float kAspect = 1.5f;

quality::RgbImage pictureOf(const gpu::Device& device, const Frame& frame) {
    const auto rgba = gpu::readImage(device, frame.display());
    quality::RgbImage picture(int(kSize.width), int(kSize.height));
    for (std::size_t i = 0; i < picture.rgb.size(); ++i)
        picture.rgb[i] = std::uint8_t(rgba[i / 3 * 4 + i % 3]);
    return picture;
}

class TemporalTest : public GpuTest {
protected:
    TemporalTest() : columns(*scene::buildBuiltin("columns")) {}
    void SetUp() override {
        GpuTest::SetUp();
        if (IsSkipped()) return;
        onGpu.emplace(device(), columns);
        camera = scene::dollied(scene::frame(onGpu->bounds(), kAspect), 0.6f);
    }
    static FrameSettings settings(TemporalMode mode) {
        FrameSettings s{.size = kSize, .maxScale = 2, .shadowMapSize = 256, .skyViews = 0};
        s.temporal.mode = mode;
        return s;
    }
    /// Four samples a pixel.
    quality::RgbImage reference(const Camera& from) {
        Frame frame(device(), *onGpu, settings(TemporalMode::off));
        frame.render(from, {.renderScale = 2});
        return pictureOf(device(), frame);
    }

    scene::Scene columns;
    std::optional<scene::GpuScene> onGpu;
    Camera camera;
};

TEST_F(TemporalTest, aStillViewConvergesPastAnySpatialFilter) {
    const auto wanted = reference(camera);
    Frame spatial(device(), *onGpu, settings(TemporalMode::off));
    spatial.render(camera, {.renderScale = 0.5f});
    const double alone = quality::psnr(wanted, pictureOf(device(), spatial));
    Frame joined(device(), *onGpu, settings(TemporalMode::lodestar));
    for (int i = 0; i < 64; ++i) joined.render(camera, {.renderScale = 0.5f});
    EXPECT_GE(quality::psnr(wanted, pictureOf(device(), joined)), alone + 3);
}

TEST_F(TemporalTest, aStillViewBecomesTheNativeOne) {
    // Full of edges, with shadows that differ from surface to surface.
    const scene::Scene source = small_scenes::jumble();
    const scene::GpuScene patches(device(), source);
    const Camera from = scene::frame(patches.bounds(), kAspect);
    const auto after = [&](float scale) {
        Frame frame(device(), patches, settings(TemporalMode::lodestar));
        for (int i = 0; i < 40; ++i) frame.render(from, {.renderScale = scale});
        return pictureOf(device(), frame);
    };
    EXPECT_GE(quality::psnr(after(1), after(0.71f)), 38);
}

TEST_F(TemporalTest, theHistoryIsKeptWhenTheScaleChanges) {
    const auto wanted = reference(camera);
    const auto after = [&](std::initializer_list<float> scales) {
        Frame frame(device(), *onGpu, settings(TemporalMode::lodestar));
        for (int i = 0; i < 60; ++i)
            frame.render(camera, {.renderScale = scales.begin()[i % scales.size()]});
        return quality::psnr(wanted, pictureOf(device(), frame));
    };
    const double steady = after({0.6f}), changing = after({0.5f, 0.71f, 0.55f, 0.64f});
    EXPECT_GE(changing, steady - 0.5);
    // Nor does one frame of another scale show.
    Frame frame(device(), *onGpu, settings(TemporalMode::lodestar));
    for (int i = 0; i < 60; ++i) frame.render(camera, {.renderScale = 0.71f});
    const auto before = pictureOf(device(), frame);
    frame.render(camera, {.renderScale = 0.5f});
    EXPECT_GE(quality::psnr(before, pictureOf(device(), frame)), 40);
}

TEST_F(TemporalTest, theHistoryIsKeptWhenTheScaleOfAnAxisChanges) {
    using budget::AxisScale;
    const auto wanted = reference(camera);
    const auto after = [&](std::initializer_list<AxisScale> scales) {
        Frame frame(device(), *onGpu, settings(TemporalMode::lodestar));
        for (std::size_t i = 0; i < 60; ++i)
            frame.render(camera, {.renderScale = scales.begin()[i % scales.size()]});
        return quality::psnr(wanted, pictureOf(device(), frame));
    };
    // Some views want the rows more and some the columns: no worse than the mean of both.
    double steady = 0;
    for (const AxisScale scale : {AxisScale(0.5f, 1), AxisScale(1, 0.5f)}) {
        Frame spatial(device(), *onGpu, settings(TemporalMode::off));
        spatial.render(camera, {.renderScale = scale});
        const double joined = after({scale});
        EXPECT_GE(joined, quality::psnr(wanted, pictureOf(device(), spatial)) + 2) << scale.x;
        steady += joined / 2;
    }
    EXPECT_GE(after({{0.5f, 1}, {1, 0.5f}, {0.84f, 0.6f}, {0.6f, 0.84f}, {0.71f, 0.71f}}),
              steady - 0.5);
    for (const AxisScale other : {AxisScale(0.5f, 1), {1, 0.5f}, {1, 0.71f}}) {
        Frame frame(device(), *onGpu, settings(TemporalMode::lodestar));
        for (int i = 0; i < 60; ++i) frame.render(camera, {.renderScale = 0.71f});
        const auto before = pictureOf(device(), frame);
        const auto bytes = device().allocatedBytes();
        frame.render(camera, {.renderScale = other});
        EXPECT_EQ(device().allocatedBytes(), bytes);
        EXPECT_GE(quality::psnr(before, pictureOf(device(), frame)), 40) << other.x;
    }
}

/// The level of detail of each instance that the last picture listed.
std::map<std::uint32_t, std::uint32_t> levelsOf(const gpu::Device& device,
                                                const scene::GpuScene& scene, const Frame& frame) {
    const geometry::DrawList& list = frame.drawList();
    const auto counts = gpu::as<shared::CullCounts>(
        gpu::readBuffer(device, list.counts, sizeof(shared::CullCounts)))[0];
    const auto clusters = gpu::as<shared::GpuCluster>(gpu::readBuffer(
        device, scene.clusters.buffer(),
        sizeof(shared::GpuCluster) *
            (list.table + std::size_t{counts.lists[shared::LS_LIST_CLUSTERS].count})));
    std::map<std::uint32_t, std::uint32_t> levels;
    for (std::size_t c = list.table; c < clusters.size(); ++c)
        if (clusters[c].triangleCount > 0) levels[clusters[c].instance] = clusters[c].lod;
    return levels;
}

TEST_F(TemporalTest, levelsOfDetailDoNotFollowTheScale) {
    scene::Scene row = small_scenes::single(
        small_scenes::parts::patch(small_scenes::parts::sphere(0.5), 48, 24, {1, 1}));
    row.instances.clear();
    for (int i = 0; i < 12; ++i)
        small_scenes::place(
            row, 0, glm::translate(glm::mat4(1), {float(i % 4) - 1.5f, 0, -2.0f * float(i)}));
    const scene::GpuScene balls(device(), row, {}, {.simplify = true});
    const Camera from{.eye = {0, 2, 6}, .at = {0, 0, -10}};
    const auto levelsAt = [&](TemporalMode mode, float scale) {
        FrameSettings s = settings(mode);
        s.cull = geometry::CullMode::frustum;
        s.lod = {.mode = geometry::LodChoice::Mode::error, .errorPx = 1, .distances = {}};
        Frame frame(device(), balls, s);
        frame.render(from, {.renderScale = scale});
        return levelsOf(device(), balls, frame);
    };
    const auto whole = levelsAt(TemporalMode::lodestar, 1);
    EXPECT_EQ(whole.size(), 12u);
    EXPECT_EQ(levelsAt(TemporalMode::lodestar, 0.5f), whole);
    EXPECT_NE(levelsAt(TemporalMode::off, 0.5f), whole) << "it would show";
}

/// Sixteen samples a pixel: of edges a pixel apart four are no reference.
FrameSettings fine(FrameSettings settings) {
    settings.maxScale = 1;
    settings.size = vk::Extent2D{4 * kSize.width, 4 * kSize.height};
    settings.temporal.mode = TemporalMode::off;
    return settings;
}

quality::RgbImage reducedPictureOf(const gpu::Device& device, const Frame& frame) {
    const auto rgba = gpu::readImage(device, frame.display());
    quality::RgbImage picture(int(kSize.width), int(kSize.height));
    for (std::size_t i = 0; i < picture.rgb.size(); ++i) {
        const std::size_t c = i % 3, x = 4 * (i / 3 % kSize.width), y = 4 * (i / 3 / kSize.width);
        unsigned sum = 8;
        for (std::size_t k = 0; k < 16; ++k)
            sum += std::to_integer<unsigned>(
                rgba[4 * ((y + k / 4) * 4 * kSize.width + x + k % 4) + c]);
        picture.rgb[i] = std::uint8_t(sum / 16);
    }
    return picture;
}

quality::RgbImage finely(const gpu::Device& device, const scene::GpuScene& scene,
                         const FrameSettings& settings, const Camera& camera) {
    Frame frame(device, scene, fine(settings));
    frame.render(camera, {});
    return reducedPictureOf(device, frame);
}

/// What joining gains on the last frame of a pan over the filter of that frame alone [dB].
double gainOfPanning(const gpu::Device& device, const scene::GpuScene& scene,
                     FrameSettings settings, const Camera& first, float step) {
    constexpr int kFrames = 24;
    const auto last = [&](TemporalMode mode) {
        settings.temporal.mode = mode;
        Frame frame(device, scene, settings);
        for (int i = mode == TemporalMode::off ? kFrames - 1 : 0; i < kFrames; ++i)
            frame.render(scene::orbited(first, first.at, step * float(i)), {.renderScale = 0.71f});
        return pictureOf(device, frame);
    };
    const auto joined = last(TemporalMode::lodestar), alone = last(TemporalMode::off);
    const auto wanted =
        finely(device, scene, settings, scene::orbited(first, first.at, step * float(kFrames - 1)));
    return quality::psnr(wanted, joined) - quality::psnr(wanted, alone);
}

TEST_F(TemporalTest, aPanningViewGainsFromItsHistory) {
    const auto chosen = settings(TemporalMode::off);
    const Camera hall{.eye = {6, 3, 9}, .at = {0, 1, 0}};
    EXPECT_GE(gainOfPanning(device(), *onGpu, chosen, hall, 0.002f), 1);
    // Small pictures full of edges.
    for (const float step : {0.002f, 0.004f}) {
        EXPECT_GE(gainOfPanning(device(), *onGpu, chosen, camera, step), 1) << step;
        const scene::Scene source = small_scenes::jumble();
        const scene::GpuScene patches(device(), source);
        EXPECT_GE(
            gainOfPanning(device(), patches, chosen, scene::frame(patches.bounds(), kAspect), step),
            0)
            << step;
    }
}

/// A wall cut out of stripes finer than the texels of a smaller picture.
scene::Scene railing(scene::AlphaMode mode) {
    scene::Material cut = scene::procedural::plain("cut", {0.8f, 0.8f, 0.8f}, 0, 0.8f);
    cut.alphaMode = mode;
    cut.alphaCutoff = 0.6f;
    cut.baseColorTexture.texture = 0;
    constexpr float kRepeats = 16;  // a pixel a texel where quad() fills the picture
    scene::Scene scene = small_scenes::single(small_scenes::quad({kRepeats, kRepeats}), cut);
    scene::Image stripes{.name = "stripes", .width = 4, .height = 4, .rgba = {}};
    for (int i = 0; i < 16; ++i)
        for (const int code : {255, 255, 255, i % 2 == 0 ? 255 : 0})
            stripes.rgba.push_back(std::uint8_t(code));
    scene.images.push_back(stripes);
    scene.textures.push_back({.image = 0});
    return scene;
}

TEST_F(TemporalTest, whatAlphaCutsOutIsAsFineAsTheOutput) {
    const auto shown = [&](const scene::GpuScene& scene, CaptureBackend capture, float scale) {
        FrameSettings s = settings(TemporalMode::lodestar);
        s.capture = capture;
        s.exposure = 1;
        Frame frame(device(), scene, s);
        for (int i = 0; i < 40; ++i) frame.render(small_scenes::facing(), {.renderScale = scale});
        return pictureOf(device(), frame);
    };
    for (const auto mode : {scene::AlphaMode::mask, scene::AlphaMode::blend}) {
        const scene::Scene source = railing(mode);
        const scene::GpuScene scene(device(), source);
        for (const auto capture : {CaptureBackend::supersample, CaptureBackend::automatic})
            EXPECT_GE(quality::psnr(shown(scene, capture, 1), shown(scene, capture, 0.5f)), 30)
                << int(mode) << int(capture);
    }
}

/// A bright quad that moves over a patterned wall.
scene::Scene passingQuad() {
    scene::procedural::SceneBuilder builder("passing");
    namespace parts = small_scenes::parts;
    const auto bright = builder.add(parts::plain("bright", {0.9f, 0.9f, 0.9f}, 0, 0.8f));
    const auto dark = builder.add(parts::plain("dark", {0.1f, 0.05f, 0.05f}, 0, 0.8f));
    const auto grey = builder.add(parts::plain("grey", {0.3f, 0.3f, 0.4f}, 0, 0.8f));
    builder.add("passing", small_scenes::quad(), bright);
    builder.add("dark", small_scenes::quad(), dark);
    builder.add("grey", small_scenes::quad(), grey);
    scene::Scene scene = std::move(builder).finish();
    small_scenes::place(scene, 0, glm::mat4(1));
    scene.nodes[scene.instances[0].node] = {};
    for (int y = -3; y <= 3; ++y)
        for (int x = -4; x <= 4; ++x)
            small_scenes::place(scene, (x + y) % 2 == 0 ? 1 : 2,
                                glm::translate(glm::mat4(1), glm::vec3(2 * x, 2 * y, -3)));
    scene::Animation animation{.duration = 1};
    animation.channels.push_back({scene.instances[0].node,
                                  scene::AnimationPath::translation,
                                  scene::Interpolation::linear,
                                  {0, 1},
                                  {{-3, 0, 0, 0}, {3, 0, 0, 0}}});
    scene.animations.push_back(animation);
    return scene;
}

struct Uncovered {
    double withHistory = 0, without = 0;
    int pixels = 0;
};

/// The error, against sixteen samples a pixel, of what the quad uncovers while it moves on by
/// `step` seconds a frame.
Uncovered uncoveredBy(const gpu::Device& device, FrameSettings settings, float step) {
    const scene::Scene source = passingQuad();
    scene::GpuScene moving(device, source);
    const Camera from{.eye = {0, 0, 8}, .at = {0, 0, 0}};
    const auto make = [&](TemporalMode mode) {
        settings.temporal.mode = mode;
        settings.shadowTaps = 0;
        return Frame(device, moving, settings);
    };
    Frame joined = make(TemporalMode::lodestar), spatial = make(TemporalMode::off),
          full = make(TemporalMode::off);
    Frame sixteen(device, moving, fine(full.settings()));
    std::vector<std::uint32_t> idsBefore;
    Uncovered found;
    for (int i = 0; i < 30; ++i) {
        moving.animate(step * float(i));
        joined.render(from, {.renderScale = 0.71f});
        spatial.render(from, {.renderScale = 0.71f});
        full.render(from, {});
        sixteen.render(from, {});
        const auto ids = gpu::as<std::uint32_t>(gpu::readImage(device, full.ids()));
        const auto a = pictureOf(device, joined), b = pictureOf(device, spatial),
                   c = reducedPictureOf(device, sixteen);
        const std::uint32_t quad = ids[kSize.width * (kSize.height / 2)];  // never the mover's
        for (std::size_t p = 0; i > 5 && p < ids.size(); ++p) {
            const std::size_t x = p % kSize.width;
            if (idsBefore[p] == ids[p] || x < 2) continue;
            // Uncovered: was bright, is not.
            if (c.rgb[3 * p] > 150 || ids[p] == quad) continue;
            ++found.pixels;
            for (int k = 0; k < 3; ++k) {
                found.withHistory += std::abs(int(a.rgb[3 * p + k]) - int(c.rgb[3 * p + k]));
                found.without += std::abs(int(b.rgb[3 * p + k]) - int(c.rgb[3 * p + k]));
            }
        }
        idsBefore = ids;
    }
    return found;
}

TEST_F(TemporalTest, uncoveredPixelsShowThisFrameAndNoGhost) {
    // Two pixels a frame, and a quarter of one: what then leaves is still beside what it uncovers.
    for (const float step : {1 / 30.0f, 1 / 240.0f}) {
        const Uncovered found = uncoveredBy(device(), settings(TemporalMode::off), step);
        EXPECT_GT(found.pixels, 60) << step;
        EXPECT_LE(found.withHistory, 1.05 * found.without) << step;
    }
}

TEST_F(TemporalTest, withoutMemoryEveryFrameStandsAlone) {
    const auto differenceOf = [&](float memory) {
        FrameSettings s = settings(TemporalMode::lodestar);
        s.temporal.memory = memory;
        Frame fromLeft(device(), *onGpu, s), fromRight(device(), *onGpu, s);
        fromLeft.render(scene::orbited(camera, camera.at, -0.1f), {});
        fromRight.render(scene::orbited(camera, camera.at, 0.1f), {});
        fromLeft.render(camera, {.renderScale = 0.71f});
        fromRight.render(camera, {.renderScale = 0.71f});
        return quality::psnr(pictureOf(device(), fromLeft), pictureOf(device(), fromRight));
    };
    EXPECT_GE(differenceOf(0), 60);
    EXPECT_LT(differenceOf(12), 60);
}

TEST_F(TemporalTest, theSourcesModeSumsTwoStillFrames) {
    Frame joined(device(), *onGpu, settings(TemporalMode::source));
    const auto wanted = reference(camera);
    Frame spatial(device(), *onGpu, settings(TemporalMode::off));
    spatial.render(camera, {});
    for (int i = 0; i < 4; ++i) joined.render(camera, {});
    EXPECT_GE(quality::psnr(wanted, pictureOf(device(), joined)),
              quality::psnr(wanted, pictureOf(device(), spatial)) + 1);
    // Odd and even frames differ, their sums do not.
    const auto one = pictureOf(device(), joined);
    joined.render(camera, {});
    EXPECT_GE(quality::psnr(one, pictureOf(device(), joined)), 50);
}

TEST_F(TemporalTest, theSourcesModeLetsGoOfWhatMoves) {
    FrameSettings s = settings(TemporalMode::source);
    s.temporal.k = 1;
    Frame joined(device(), *onGpu, s), fresh(device(), *onGpu, s);
    joined.render(camera, {});
    const Camera later = scene::orbited(camera, camera.at, 0.3f);
    joined.render(later, {});
    fresh.render(camera, {});
    fresh.reset();
    fresh.render(later, {});
    // Points near the orbit's axis move less than a pixel and keep a little.
    EXPECT_GE(quality::psnr(pictureOf(device(), fresh), pictureOf(device(), joined)), 30);
}

TEST_F(TemporalTest, changingTheScaleAllocatesNothing) {
    Frame frame(device(), *onGpu, settings(TemporalMode::lodestar));
    frame.render(camera, {});
    const auto before = device().allocatedBytes();
    for (const float scale : {0.5f, 2.0f, 0.71f}) frame.render(camera, {.renderScale = scale});
    EXPECT_EQ(device().allocatedBytes(), before);
}

/// The part of the inputs in use.
class TemporalLivePart : public TemporalTest, public testing::WithParamInterface<vk::Extent2D> {};
INSTANTIATE_TEST_SUITE_P(Shapes, TemporalLivePart,
                         testing::Values(vk::Extent2D{17, 23}, vk::Extent2D{15, 40},
                                         vk::Extent2D{39, 21}));

TEST_P(TemporalLivePart, isAllThatIsRead) {
    const vk::Extent2D room{40, 40}, live = GetParam(), size{30, 41};
    using Usage = vk::ImageUsageFlagBits;
    const auto filled = [&](vk::Format format, const auto& inside, const auto& outside) {
        gpu::Image image(device(), {.name = "input",
                                    .format = format,
                                    .extent = room,
                                    .usage = Usage::eSampled | Usage::eStorage |
                                             Usage::eTransferDst | Usage::eTransferSrc});
        std::vector<std::decay_t<decltype(inside)>> texels;
        for (std::uint32_t y = 0; y < room.height; ++y)
            for (std::uint32_t x = 0; x < room.width; ++x)
                texels.push_back(x < live.width && y < live.height ? inside : outside);
        gpu::uploadImage(device(), image, 0, std::as_bytes(std::span(texels)));
        return image;
    };
    const auto half = [](float v) { return glm::packHalf4x16(glm::vec4(v)); };
    for (const TemporalMode mode : {TemporalMode::source, TemporalMode::lodestar}) {
        // The source's mode copies the picture, so it must have that format.
        const bool source = mode == TemporalMode::source;
        const gpu::Image color =
            source ? filled(vk::Format::eR8G8B8A8Unorm, 0xff808080u, 0xffffffffu)
                   : filled(vk::Format::eR16G16B16A16Sfloat, half(128 / 255.0f), half(NAN));
        const gpu::Image motion =
            filled(vk::Format::eR32G32B32A32Sfloat, glm::vec4(0, 0, 5, 1), glm::vec4(NAN));
        const gpu::Image depth = filled(vk::Format::eR32Sfloat, 5.0f, NAN);
        const gpu::Image terms = filled(vk::Format::eR16G16B16A16Sfloat, half(1), half(NAN));
        const gpu::Image material =
            filled(vk::Format::eR32G32B32A32Uint, glm::uvec4(~0u), glm::uvec4(0));
        const gpu::Image out(device(), {.name = "out",
                                        .format = vk::Format::eR8G8B8A8Unorm,
                                        .extent = size,
                                        .usage = Usage::eStorage | Usage::eTransferSrc});
        scale::Temporal pass(device(), room, size, {.mode = mode});
        for (std::uint32_t i = 0; i < 6; ++i) {
            gpu::Recorder rec(device());
            rec.begin();
            pass.record(rec,
                        {.color = color,
                         .motion = motion,
                         .depth = depth,
                         .terms = terms,
                         .material = material,
                         .live = live,
                         .jitter = scale::jitterOf(mode, i)},
                        out);
            rec.submit();
            for (const glm::u8vec4 texel : gpu::as<glm::u8vec4>(gpu::readImage(device(), out)))
                ASSERT_NEAR(texel.x, 128, 1) << i;
        }
    }
}

TEST(Jitter, coversTheTexelEvenlyAndIsCentredOverAnyRun) {
    constexpr int kRun = 32;  // about as many frames as a pixel remembers at S = 0.71
    for (int first = 0; first < 200; ++first) {
        glm::dvec2 mean(0);
        int quadrants[4] = {};
        for (int i = first; i < first + kRun; ++i) {
            const glm::vec2 j = scale::jitterOf(TemporalMode::lodestar, std::uint32_t(i));
            ASSERT_LE(std::max(std::abs(j.x), std::abs(j.y)), 0.5f);
            mean += glm::dvec2(j) / double(kRun);
            ++quadrants[(j.x > 0) + 2 * (j.y > 0)];
        }
        EXPECT_LT(glm::length(mean), 0.08) << first;
        for (const int n : quadrants) EXPECT_GE(n, kRun / 4 - 3) << first;
    }
    // No place comes twice within a hundred frames.
    for (std::uint32_t i = 0; i < 100; ++i)
        for (std::uint32_t k = i + 1; k < 100; ++k)
            ASSERT_NE(scale::jitterOf(TemporalMode::lodestar, i),
                      scale::jitterOf(TemporalMode::lodestar, k));
    EXPECT_EQ(scale::jitterOf(TemporalMode::off, 3), glm::vec2(0));
    const glm::vec2 even = scale::jitterOf(TemporalMode::source, 4),
                    odd = scale::jitterOf(TemporalMode::source, 5);
    EXPECT_EQ(even - odd, glm::vec2(0.5f));
}

TEST(TextureBias, isThatOfEachAxis) {
    using scale::textureScaleOf;
    EXPECT_EQ(textureScaleOf(TemporalMode::lodestar, {0.5f, 1}), glm::vec2(0.5f, 1));
    EXPECT_EQ(textureScaleOf(TemporalMode::lodestar, {2, 0.71f}), glm::vec2(1, 0.71f));
    EXPECT_EQ(textureScaleOf(TemporalMode::off, {0.5f, 1}), glm::vec2(1));
    EXPECT_EQ(textureScaleOf(TemporalMode::source, {0.5f, 1}), glm::vec2(std::exp2(-0.5f)));
}

TEST_F(TemporalTest, refusesWhatMakesNoSense) {
    const auto make = [&](scale::TemporalOptions o) {
        return scale::Temporal(device(), {4, 4}, {4, 4}, o);
    };
    using O = scale::TemporalOptions;
    EXPECT_THROW(make(O{}), std::invalid_argument);
    EXPECT_THROW(make(O{.mode = TemporalMode::source, .k = -1}), std::invalid_argument);
    EXPECT_THROW(make(O{.mode = TemporalMode::lodestar, .width = 0}), std::invalid_argument);
    EXPECT_THROW(make(O{.mode = TemporalMode::lodestar, .memory = -1}), std::invalid_argument);
    EXPECT_THROW(make(O{.mode = TemporalMode::lodestar, .sharpness = 2}), std::invalid_argument);
    Frame frame(device(), *onGpu, settings(TemporalMode::lodestar));
    EXPECT_THROW(frame.render(camera, {.shadingRate = 2, .resizeAll = true}),
                 std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
// Blended surfaces over what is opaque.
#include <glm/gtc/packing.hpp>

#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {
namespace {

using scene::AlphaMode;
using scene::Camera;
using scene::Material;
using scene::Scene;

class LayerTest : public GpuTest {
protected:
    static constexpr vk::Extent2D kSize{72, 48};

    static FrameSettings settings() {
        FrameSettings s{.size = kSize};
        s.shadowTaps = 0;
        s.skyViews = 0;
        s.cull = geometry::CullMode::hiz;
        return s;
    }
    /// Shows the colour it is given, whatever the light.
    static Material unlit(glm::vec3 color, float alpha = 1) {
        Material m;
        m.baseColor = glm::vec4(color, alpha);
        m.unlit = true;
        m.doubleSided = true;
        m.alphaMode = alpha < 1 ? AlphaMode::blend : AlphaMode::opaque;
        return m;
    }
    static Camera view() { return {.eye = {0, 0, 6}, .at = {0, 0, 0}, .verticalFov = 0.5f}; }
    static std::vector<glm::vec4> radiance(const Frame& frame) {
        std::vector<glm::vec4> texels;
        for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device(), frame.radiance())))
            texels.push_back(glm::unpackHalf4x16(bits));
        return texels;
    }
    static glm::vec4 middle(const Frame& frame) {
        return radiance(frame)[kSize.height / 2 * kSize.width + kSize.width / 2];
    }
    /// Panes one behind the other before a wall, in the order in which they are listed.
    struct Pane {
        float z;
        glm::vec3 color;
        float alpha;
    };
    static Scene panes(const std::vector<Pane>& list) {
        small_scenes::SceneBuilder builder("panes");
        for (const Pane& pane : list) {
            const auto mesh = builder.add("pane", small_scenes::quad(),
                                          builder.add(unlit(pane.color, pane.alpha)));
            builder.place(mesh, {0, 0, pane.z});
        }
        return std::move(builder).finish();
    }
};

TEST_F(LayerTest, panesCoverWhatIsBehindThemInWhateverOrderTheyAreGiven) {
    const Pane wall{-1, {0.25f, 0.25f, 0.25f}, 1}, red{0, {0.81f, 0, 0}, 0.5f},
        blue{0.5f, {0, 0, 0.64f}, 0.25f}, behind{-2, {0, 1, 0}, 0.5f};
    const glm::vec3 expected = 0.25f * blue.color + 0.75f * (0.5f * red.color + 0.5f * wall.color);
    for (const auto& order : {std::vector<Pane>{wall, red, blue, behind},
                              {behind, blue, wall, red},
                              {blue, behind, red, wall}}) {
        const Scene source = panes(order);
        const scene::GpuScene onGpu(device(), source);
        Frame frame(device(), onGpu, settings());
        for (const float scale : {1.0f, 0.5f, 0.37f, 0.25f}) {
            frame.render(view(), {.layerScale = scale});
            const glm::vec4 shown = middle(frame);
            EXPECT_LT(glm::distance(glm::vec3(shown), expected), 6e-3f) << scale;
            EXPECT_LT(shown.a, 2e-3f);  // nothing here gets a tone curve
        }
    }
}

TEST_F(LayerTest, moreThanFourPanesShowTheNearestFour) {
    std::vector<Pane> list{{-1, {0, 0, 0}, 1}};
    for (int i = 0; i < 6; ++i) list.push_back({0.1f * float(i), {1, 1, 1}, 0.5f});
    const Scene source = panes(list);
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settings());
    frame.render(view(), {});
    EXPECT_NEAR(middle(frame).g, 1 - std::pow(0.5f, 4), 4e-3f);
    EXPECT_GT(frame.blendedFragments(), 4 * 400u);
}

TEST_F(LayerTest, aBlendMaterialThatIsOpaqueIsAnOpaqueOne) {
    Scene source = panes({{-1, {0.3f, 0.3f, 0.3f}, 1}, {0, {0.8f, 0.2f, 0.1f}, 1}});
    const scene::GpuScene opaque(device(), source);
    for (Material& m : source.materials) m.alphaMode = AlphaMode::blend;
    const scene::GpuScene blended(device(), source);
    EXPECT_FALSE(blended.features().blended);
    Frame a(device(), opaque, settings()), b(device(), blended, settings());
    a.render(view(), {});
    b.render(view(), {});
    EXPECT_EQ(gpu::readImage(device(), a.display()), gpu::readImage(device(), b.display()));
}

TEST_F(LayerTest, litGlassIsShadedAsAnOpaqueSurfaceIs) {
    // At alpha ½ over black it is half as bright as the same surface made opaque.
    Scene source = panes({{-1, {0, 0, 0}, 1}, {0, {0.7f, 0.5f, 0.3f}, 0.5f}});
    source.materials[1].unlit = false;
    const scene::GpuScene thin(device(), source);
    source.materials[1].alphaMode = AlphaMode::opaque;
    const scene::GpuScene solid(device(), source);
    FrameSettings s = settings();
    s.shadowTaps = 3;
    s.skyViews = 4;
    s.shadowMapSize = s.skyMapSize = 128;
    Frame a(device(), thin, s), b(device(), solid, s);
    a.render(view(), {});
    b.render(view(), {});
    // The solid one hides some of its sky from itself: glass does not.
    EXPECT_LT(glm::distance(2.0f * glm::vec3(middle(a)), glm::vec3(middle(b))),
              0.05f * glm::length(glm::vec3(middle(b))));
}

TEST_F(LayerTest, aCoarseLayerNeitherLeaksOverEdgesNorLeavesGaps) {
    // A pane behind a box, before a wall: the box stays as it is, up to its edge; beside it the
    // pane begins at once.
    small_scenes::SceneBuilder builder("edge");
    const auto add = [&](scene::Mesh mesh, const Material& material, glm::vec3 at) {
        builder.place(builder.add("mesh", std::move(mesh), builder.add(material)), at);
    };
    add(small_scenes::parts::box({-6, -6, -2}, {6, 6, -1.9}, 1), unlit({0.2f, 0.2f, 0.2f}), {});
    add(small_scenes::quad(), unlit({0.9f, 0.1f, 0.1f}, 0.6f), {0, 0, 0});
    add(small_scenes::parts::box({-0.37, -0.41, 1}, {0.33, 0.39, 1.5}, 1), unlit({0, 0.6f, 0}), {});
    const Scene source = std::move(builder).finish();
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settings());
    frame.render(view(), {});
    const std::vector<glm::vec4> full = radiance(frame);
    const auto depths = gpu::as<float>(gpu::readImage(device(), frame.depth()));
    for (const float scale : {0.71f, 0.5f, 0.25f}) {
        frame.render(view(), {.layerScale = scale});
        const std::vector<glm::vec4> coarse = radiance(frame);
        int box = 0, inside = 0;
        for (std::size_t i = 0; i < full.size(); ++i) {
            const glm::ivec2 at(i % kSize.width, i / kSize.width);
            if (depths[i] < 5.2f) {
                ASSERT_LT(glm::distance(coarse[i], full[i]), 3e-3f) << i << " at " << scale;
                ++box;
            } else if (std::abs(at.x - 36) < 12 && std::abs(at.y - 24) < 12) {
                ASSERT_LT(glm::distance(coarse[i], full[i]), 3e-3f) << i << " at " << scale;
                ++inside;  // of the pane, away from its own edge
            }
        }
        EXPECT_GT(box, 80);
        EXPECT_GT(inside, 200);
    }
}

TEST_F(LayerTest, aViewportOfAnyShapeHasTheLayerThatATargetOfItsSizeHas) {
    const Scene source = panes({{-1, {0.2f, 0.2f, 0.2f}, 1}, {0, {0.9f, 0.1f, 0.1f}, 0.6f}});
    const scene::GpuScene onGpu(device(), source);
    FrameSettings s = settings();
    s.aspect = 1.5f;
    Frame large(device(), onGpu, s);
    for (const auto& [scale, size] :
         {std::pair{budget::AxisScale(0.5f, 1), vk::Extent2D{36, 48}}, {{1, 0.5f}, {72, 24}}}) {
        FrameSettings small = s;
        small.size = size;
        Frame alone(device(), onGpu, small);
        for (const float layerScale : {1.0f, 0.5f}) {
            large.render(view(), {});  // what the unused part then holds
            large.render(view(), {.renderScale = scale, .layerScale = layerScale});
            alone.render(view(), {.layerScale = layerScale});
            EXPECT_EQ(radiance(large), radiance(alone)) << scale.x << " " << layerScale;
        }
    }
}

TEST_F(LayerTest, aFrameOwesNothingToTheScalesOfThoseBefore) {
    // Two of the panes fill the picture: more than there is room for where nothing is known.
    Scene source = panes({{-1, {0.5f, 0.5f, 0.5f}, 1},
                          {0, {0.9f, 0.1f, 0.1f}, 0.6f},
                          {0.3f, {0.1f, 0.5f, 0.1f}, 0.3f},
                          {0.6f, {0.1f, 0.1f, 0.7f}, 0.3f}});
    for (Material& m : source.materials) m.unlit = false;
    source.nodes[source.instances[1].node].scale = {0.6f, 0.7f, 1};
    for (const int i : {2, 3}) source.nodes[source.instances[i].node].scale = {3, 3, 1};
    const scene::GpuScene onGpu(device(), source);
    FrameSettings s = settings();
    s.shadowTaps = 3;
    s.skyViews = 2;
    s.shadowMapSize = s.skyMapSize = 128;
    const std::array<budget::Levers, 5> all{
        budget::Levers{.renderScale = 0.5f, .shadowScale = 0.25f, .layerScale = 0.25f},
        {.renderScale = {1, 0.5f}, .shadowScale = 0.5f, .layerScale = 0.71f},
        {.shadowScale = 0.25f, .layerScale = 0.25f},
        {},
        {.renderScale = 0.71f, .shadowScale = 0.875f, .layerScale = 0.5f}};
    const auto shown = [](Frame& frame, const budget::Levers& levers) {
        frame.render(view(), levers);
        return std::pair(gpu::readImage(device(), frame.display()), frame.blendedFragments());
    };
    Frame one(device(), onGpu, s);
    one.render(view(), all[0]);
    const auto bytes = device().allocatedBytes();  // from the least of all on
    std::vector<std::pair<std::vector<std::byte>, std::uint32_t>> there;
    for (const budget::Levers& levers : all) there.push_back(shown(one, levers));
    EXPECT_EQ(device().allocatedBytes(), bytes);
    EXPECT_GT(there[3].second, 4096u);
    Frame other(device(), onGpu, s);
    for (std::size_t i = all.size(); i-- > 0;)
        EXPECT_EQ(shown(other, all[i]), there[i]) << "of levers " << i;
}

TEST_F(LayerTest, aMovingPaneLeavesNoGhostInTheHistory) {
    Scene source = panes({{-1, {0.2f, 0.2f, 0.2f}, 1}, {0, {0.9f, 0.5f, 0.1f}, 0.6f}});
    source.nodes[source.instances[1].node].scale = {0.3f, 0.5f, 1};
    scene::Animation animation{.name = "by", .duration = 100, .channels = {}};
    animation.channels.push_back({.node = source.instances[1].node,
                                  .path = scene::AnimationPath::translation,
                                  .interpolation = scene::Interpolation::linear,
                                  .times = {0, 100},
                                  .values = {{-0.9f, 0, 0, 0}, {99.1f, 0, 0, 0}},
                                  .weights = {}});
    source.animations.push_back(animation);
    scene::GpuScene onGpu(device(), source);
    FrameSettings s = settings();
    Frame plain(device(), onGpu, s);
    for (const scale::TemporalMode mode :
         {scale::TemporalMode::lodestar, scale::TemporalMode::source}) {
        s.temporal.mode = mode;
        Frame joined(device(), onGpu, s);
        for (int i = 0; i <= 12; ++i) {
            onGpu.animate(0.1f * float(i));
            joined.render(view(), {});
        }
        plain.render(view(), {});
        const auto now = gpu::readImage(device(), plain.display());
        const auto shown = gpu::readImage(device(), joined.display());
        // Two pixels off the pane's edges, which are not where they are without jitter.
        int worst = 0;
        for (std::uint32_t y = 4; y < kSize.height - 4; ++y)
            for (std::uint32_t x = 20; x < kSize.width - 20; ++x) {
                bool flat = true;
                const std::size_t at = 4 * (y * kSize.width + x);
                for (int dy = -2; dy <= 2; ++dy)
                    for (int dx = -2; dx <= 2; ++dx)
                        flat = flat && now[4 * ((y + std::uint32_t(dy)) * kSize.width + x +
                                                std::uint32_t(dx))] == now[at];
                if (flat) worst = std::max(worst, std::abs(int(shown[at]) - int(now[at])));
            }
        EXPECT_LE(worst, 10) << scale::kTemporalNames[std::size_t(mode)];
    }
}

TEST_F(LayerTest, scalesOutOfRangeAreRefused) {
    const Scene source = panes({{0, {1, 1, 1}, 0.5f}});
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settings());
    EXPECT_THROW(frame.render(view(), {.layerScale = 0.2f}), std::invalid_argument);
    EXPECT_THROW(frame.render(view(), {.layerScale = 1.1f}), std::invalid_argument);
    frame.render(view(), {});
}

TEST_F(LayerTest, severalSamplesAPixelAndRebuildingHaveTheLayerToo) {
    const Scene source = panes({{-1, {0.25f, 0.25f, 0.25f}, 1}, {0, {0.81f, 0, 0}, 0.5f}});
    const scene::GpuScene onGpu(device(), source);
    const glm::vec3 expected = 0.5f * glm::vec3(0.25f) + 0.5f * glm::vec3(0.81f, 0, 0);
    FrameSettings s = settings();
    s.captureSide = 2;
    Frame several(device(), onGpu, s);
    several.render(view(), {});
    EXPECT_LT(glm::distance(glm::vec3(middle(several)), expected), 6e-3f);
    CaptureFrame capture(device(), onGpu, {.base = kSize, .side = 1});
    capture.capture(view());
    Frame frame(device(), onGpu, settings());
    frame.rebuild(capture.compact(), view(), {});
    EXPECT_LT(glm::distance(glm::vec3(middle(frame)), expected), 6e-3f);
}

}  // namespace
}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
// Frames rendered at another scale than they are shown at.
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/procedural.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {
namespace {

class DynamicResolution : public GpuTest {
protected:
    DynamicResolution() : source(*scene::buildBuiltin("columns")) {}
    void SetUp() override {
        GpuTest::SetUp();
        if (testing::Test::IsSkipped()) return;
        onGpu.emplace(device(), source);
        camera = scene::frame(onGpu->bounds(), 1.5f);
    }
    static FrameSettings settings(std::uint32_t width, std::uint32_t height, float maxScale) {
        return {.size = {width, height}, .maxScale = maxScale, .shadowMapSize = 256};
    }
    static std::vector<std::byte> radianceOf(const Frame& frame) {
        return gpu::readImage(device(), frame.radiance());
    }

    scene::Scene source;
    std::optional<scene::GpuScene> onGpu;
    scene::Camera camera;
};

TEST_F(DynamicResolution, aViewportShowsWhatATargetOfItsSizeShows) {
    for (const budget::Levers levers :
         {budget::Levers{}, budget::Levers{.shadingRate = 2.5f, .repair = 0.05f},
          budget::Levers{.shadingRate = 3, .resizeAll = true}}) {
        Frame large(device(), *onGpu, settings(96, 64, 1.5f));
        large.render(camera, {.renderScale = 1.5f});  // what the unused part then holds
        for (const auto& [scale, size] :
             {std::pair{0.5f, vk::Extent2D{48, 32}}, {0.75f, {72, 48}}, {1.25f, {120, 80}}}) {
            budget::Levers scaled = levers;
            scaled.renderScale = scale;
            large.render(camera, scaled);
            ASSERT_EQ(large.grid(), size);
            Frame alone(device(), *onGpu, settings(size.width, size.height, 1));
            alone.render(camera, levers);
            EXPECT_EQ(radianceOf(large), radianceOf(alone)) << scale;
            EXPECT_EQ(large.repairedPixels(), alone.repairedPixels()) << scale;
        }
    }
}

TEST_F(DynamicResolution, soItDoesWhereTheAxesHaveScalesOfTheirOwn) {
    const auto shaped = [](vk::Extent2D size) {
        FrameSettings s = settings(size.width, size.height, 1);
        s.aspect = 1.5f;  // of the picture: its pixels are not square
        s.cull = geometry::CullMode::hiz;
        s.lod.mode = geometry::LodChoice::Mode::error;
        return s;
    };
    FrameSettings all = shaped({96, 64});
    all.maxScale = {1.5f, 1.25f};
    const budget::Levers levers{.shadingRate = 2.5f, .repair = 0.05f};
    Frame large(device(), *onGpu, all);
    large.render(camera, {.renderScale = {1.5f, 1.25f}});  // what the unused part then holds
    for (const auto& [scale, size] : {std::pair{budget::AxisScale(0.5f, 1), vk::Extent2D{48, 64}},
                                      {{1, 0.5f}, {96, 32}},
                                      {{1.5f, 0.75f}, {144, 48}},
                                      {{0.75f, 1.25f}, {72, 80}}}) {
        budget::Levers scaled = levers;
        scaled.renderScale = scale;
        large.render(camera, scaled);
        ASSERT_EQ(large.grid(), size);
        Frame alone(device(), *onGpu, shaped(size));
        alone.render(camera, levers);
        EXPECT_EQ(radianceOf(large), radianceOf(alone)) << scale.x << " " << scale.y;
        EXPECT_EQ(large.repairedPixels(), alone.repairedPixels()) << scale.x << " " << scale.y;
    }
}

TEST_F(DynamicResolution, whatOneAxisLosesTheOtherDoesNot) {
    // Beams across the picture, which half as many columns do not change and half as many rows do.
    small_scenes::SceneBuilder builder("beams");
    const auto white = builder.add(small_scenes::parts::plain("white", {0.9f, 0.9f, 0.9f}, 0, 1));
    for (int i = -6; i <= 6; ++i)
        builder.place(
            builder.add("beam", small_scenes::parts::box({-9, -0.1, 0}, {9, 0.1, 0.1}, 1), white),
            {0, 0.45f * float(i), 0});
    const scene::Scene source = std::move(builder).finish();
    const scene::GpuScene beams(device(), source);
    FrameSettings s = settings(60, 40, 1);
    s.shadowTaps = s.skyViews = 0;
    Frame frame(device(), beams, s);
    const scene::Camera from{.eye = {0, 0, 6}, .at = {0, 0, 0}, .verticalFov = 0.6f};
    const auto shown = [&](budget::AxisScale scale) {
        frame.render(from, {.renderScale = scale});
        return gpu::readImage(device(), frame.display());
    };
    const auto full = shown(1);
    const auto worst = [&](budget::AxisScale scale) {
        int difference = 0;
        const auto picture = shown(scale);
        for (std::size_t i = 0; i < full.size(); ++i)
            difference = std::max(difference, std::abs(int(picture[i]) - int(full[i])));
        return difference;
    };
    EXPECT_LE(worst({0.5f, 1}), 4);
    EXPECT_GE(worst({1, 0.5f}), 60);
}

TEST_F(DynamicResolution, changingTheScaleAllocatesNothing) {
    Frame frame(device(), *onGpu, settings(60, 40, 2));
    frame.render(camera, {.shadingRate = 2});
    const auto before = device().allocatedBytes();
    using budget::AxisScale;
    for (const AxisScale scale :
         {AxisScale(0.5f), AxisScale(2), AxisScale(0.5f, 1.41f), AxisScale(2, 0.71f), AxisScale(1)})
        frame.render(camera, {.shadingRate = 2, .renderScale = scale});
    EXPECT_EQ(device().allocatedBytes(), before);
}

TEST_F(DynamicResolution, theShownPictureHasTheOutputSizeAtEveryScale) {
    Frame frame(device(), *onGpu, settings(60, 40, 2));
    frame.render(camera, {});
    const auto full = gpu::readImage(device(), frame.display());
    const auto differenceAt = [&](float scale) {
        frame.render(camera, {.renderScale = scale});
        const auto shown = gpu::readImage(device(), frame.display());
        EXPECT_EQ(shown.size(), full.size());
        double sum = 0;
        for (std::size_t i = 0; i < full.size(); ++i)
            sum += std::abs(int(shown[i]) - int(full[i])) / double(full.size());
        return sum;
    };
    EXPECT_EQ(differenceAt(1), 0);
    const double at71 = differenceAt(0.71f), atHalf = differenceAt(0.5f);
    EXPECT_GT(at71, 0.1);
    EXPECT_GT(atHalf, at71);
    EXPECT_LT(atHalf, 16);  // and is the same picture
    EXPECT_LT(differenceAt(2), 8);
}

TEST_F(DynamicResolution, aScaleOfTheLightMapsReadsNothingBesideTheirLivePart) {
    const auto withMaps = [](std::uint32_t sun, std::uint32_t sky) {
        FrameSettings s = settings(96, 64, 1);
        s.shadowMapSize = sun;
        s.skyMapSize = sky;
        return s;
    };
    Frame large(device(), *onGpu, withMaps(256, 128));
    large.render(camera, {});  // what the unused part then holds
    const auto full = radianceOf(large);
    const auto before = device().allocatedBytes();
    for (const auto& [scale, sun, sky] : {std::tuple{0.5f, 128u, 64u}, {0.25f, 64u, 32u}}) {
        large.render(camera, {.shadowScale = scale});
        EXPECT_EQ(device().allocatedBytes(), before);
        Frame alone(device(), *onGpu, withMaps(sun, sky));
        alone.render(camera, {});
        EXPECT_EQ(radianceOf(large), radianceOf(alone)) << scale;
        EXPECT_NE(radianceOf(large), full) << scale;
    }
    large.render(camera, {});
    EXPECT_EQ(radianceOf(large), full);
    for (const float bad : {0.2f, 1.1f, NAN})
        EXPECT_THROW(large.render(camera, {.shadowScale = bad}), std::invalid_argument);
}

TEST_F(DynamicResolution, refusesScalesOutOfRange) {
    EXPECT_THROW(Frame(device(), *onGpu, settings(8, 8, 2.1f)), std::invalid_argument);
    EXPECT_THROW(Frame(device(), *onGpu, settings(8, 8, 0.4f)), std::invalid_argument);
    Frame frame(device(), *onGpu, settings(8, 8, 1.2f));
    EXPECT_THROW(frame.render(camera, {.renderScale = 1.3f}), std::invalid_argument);
    EXPECT_THROW(frame.render(camera, {.renderScale = 0.4f}), std::invalid_argument);
    EXPECT_THROW(frame.render(camera, {.renderScale = NAN}), std::invalid_argument);
    FrameSettings wide = settings(8, 8, 1);
    wide.maxScale = {1.5f, 0.5f};  // targets are never made for less than 1
    Frame shaped(device(), *onGpu, wide);
    shaped.render(camera, {.renderScale = {1.5f, 1}});
    for (const budget::AxisScale bad :
         {budget::AxisScale(1, 1.1f), {1.6f, 1}, {1, 0.4f}, {NAN, 1}, {1, NAN}})
        EXPECT_THROW(shaped.render(camera, {.renderScale = bad}), std::invalid_argument);
    wide.maxScale = {1, 2.1f};
    EXPECT_THROW(Frame(device(), *onGpu, wide), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::frame

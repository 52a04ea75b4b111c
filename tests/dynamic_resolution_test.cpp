// SPDX-License-Identifier: Apache-2.0
// Frames rendered at another scale than they are shown at.
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/procedural.hpp>

#include "gpu_device.hpp"

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

TEST_F(DynamicResolution, changingTheScaleAllocatesNothing) {
    Frame frame(device(), *onGpu, settings(60, 40, 2));
    frame.render(camera, {.shadingRate = 2});
    const auto before = device().peakBytes();
    for (const float scale : {0.5f, 2.0f, 0.71f, 1.0f, 1.41f})
        frame.render(camera, {.shadingRate = 2, .renderScale = scale});
    EXPECT_EQ(device().peakBytes(), before);
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
    const auto before = device().peakBytes();
    for (const auto& [scale, sun, sky] : {std::tuple{0.5f, 128u, 64u}, {0.25f, 64u, 32u}}) {
        large.render(camera, {.shadowScale = scale});
        EXPECT_EQ(device().peakBytes(), before);
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
}

}  // namespace
}  // namespace lodestar::frame

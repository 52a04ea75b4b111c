// SPDX-License-Identifier: Apache-2.0
// The effects in frames.
#include <glm/gtc/packing.hpp>

#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/procedural.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::post {
namespace {

using glm::vec3;

class PostFrameTest : public GpuTest {
protected:
    PostFrameTest() : source(*scene::buildBuiltin("columns")) {}
    void SetUp() override {
        GpuTest::SetUp();
        if (testing::Test::IsSkipped()) return;
        onGpu.emplace(device(), source);
        camera = scene::frame(onGpu->bounds(), 1.5f);
    }
    static frame::FrameSettings settings(bool ssao, bool dof) {
        frame::FrameSettings s{.size = {144, 96}, .shadowMapSize = 128, .skyMapSize = 64};
        s.post.ssao = ssao;
        s.post.occlusion = {.radius = 6, .strength = 4};
        if (dof) s.post.dof = DofOptions{.sharp = 0.2f, .full = 2, .radius = 0.1f};
        return s;
    }
    static std::vector<vec3> radianceOf(const frame::Frame& frame) {
        std::vector<vec3> rgb;
        for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device(), frame.radiance())))
            rgb.emplace_back(glm::unpackHalf4x16(bits));
        return rgb;
    }
    static double distance(const std::vector<vec3>& a, const std::vector<vec3>& b) {
        double sum = 0;
        for (std::size_t i = 0; i < a.size(); ++i)
            sum += glm::distance(glm::min(a[i], vec3(4)), glm::min(b[i], vec3(4)));
        return sum / double(a.size());
    }

    scene::Scene source;
    std::optional<scene::GpuScene> onGpu;
    scene::Camera camera;
};

TEST_F(PostFrameTest, coarseGridsGiveNearlyWhatTheFinestDoes) {
    for (const auto& [ssao, dof] : {std::pair{true, false}, {false, true}}) {
        frame::Frame plain(device(), *onGpu, settings(false, false));
        plain.render(camera, {});
        const auto without = radianceOf(plain);
        frame::Frame frame(device(), *onGpu, settings(ssao, dof));
        frame.render(camera, {});
        const auto fine = radianceOf(frame);
        const double effect = distance(without, fine);
        EXPECT_GT(effect, 5e-4) << ssao;
        for (const std::uint32_t rate : {4u, 16u}) {
            frame.render(camera, {.postRates = {rate, rate, rate}});
            EXPECT_LT(distance(radianceOf(frame), fine), (rate == 4 ? 0.5 : 0.8) * effect)
                << ssao << " " << rate;
        }
        EXPECT_THROW(frame.render(camera, {.postRates = {2, 2, 2}}), std::invalid_argument);
    }
}

TEST_F(PostFrameTest, ssaoOnlyTakesLightAway) {
    frame::Frame plain(device(), *onGpu, settings(false, false));
    plain.render(camera, {});
    const auto without = radianceOf(plain);
    frame::Frame frame(device(), *onGpu, settings(true, false));
    frame.render(camera, {.postRates = {4, 4, 4}});
    const auto with = radianceOf(frame);
    for (std::size_t i = 0; i < with.size(); ++i) ASSERT_LE(with[i].y, without[i].y * 1.001f);
}

TEST_F(PostFrameTest, theSameFrameGivesTheSameBytesAtAnyScaleItComesFrom) {
    frame::FrameSettings s = settings(true, true);
    s.maxScale = 1.5f;
    const budget::Levers levers{.postRates = {4, 16, 4}};
    frame::Frame large(device(), *onGpu, s);
    budget::Levers scaled = levers;
    scaled.renderScale = 1.5f;
    large.render(camera, scaled);  // what the unused part then holds
    scaled.renderScale = 0.5f;
    large.render(camera, scaled);
    const auto first = gpu::readImage(device(), large.radiance());
    large.render(camera, scaled);
    EXPECT_EQ(gpu::readImage(device(), large.radiance()), first);
    s.size = vk::Extent2D{72, 48};
    s.maxScale = 1;
    frame::Frame alone(device(), *onGpu, s);
    alone.render(camera, levers);
    EXPECT_EQ(gpu::readImage(device(), alone.radiance()), first);
}

TEST_F(PostFrameTest, andWhereTheAxesHaveScalesOfTheirOwn) {
    frame::FrameSettings s = settings(true, true);
    s.aspect = 1.5f;
    s.post.shutter = 1;
    const scene::Camera moved = scene::orbited(camera, camera.at, 0.03f);
    frame::Frame large(device(), *onGpu, s);
    for (const auto& [scale, size] :
         {std::pair{budget::AxisScale(0.5f, 1), vk::Extent2D{72, 96}}, {{1, 0.5f}, {144, 48}}}) {
        const budget::Levers levers{.postRates = {4, 16, 4}};
        budget::Levers scaled = levers;
        scaled.renderScale = scale;
        large.render(camera, {});  // what the unused part then holds
        large.render(moved, scaled);
        frame::FrameSettings small = s;
        small.size = size;
        frame::Frame alone(device(), *onGpu, small);
        alone.render(camera, levers);
        alone.render(moved, levers);
        EXPECT_EQ(gpu::readImage(device(), alone.radiance()),
                  gpu::readImage(device(), large.radiance()));
    }
}

TEST_F(PostFrameTest, recordsGiveTheirRepresentativesToTheEffects) {
    frame::CaptureFrame capture(device(), *onGpu, {.base = {72, 48}, .side = 2});
    capture.capture(camera);
    frame::Frame frame(device(), *onGpu, settings(true, true));
    frame.rebuild(capture.compact(), camera, {});
    const auto fine = radianceOf(frame);
    frame.rebuild(capture.compact(), camera, {.postRates = {4, 4, 4}});
    const auto coarse = radianceOf(frame);
    frame::Frame plain(device(), *onGpu, settings(false, false));
    plain.rebuild(capture.compact(), camera, {});
    EXPECT_LT(distance(coarse, fine), 0.5 * distance(fine, radianceOf(plain)));

    frame::FrameSettings s = settings(true, true);
    s.captureSide = 2;
    frame::Frame smooth(device(), *onGpu, s);
    smooth.render(camera, {.postRates = {4, 4, 4}});
    EXPECT_LT(distance(radianceOf(smooth), fine), distance(fine, radianceOf(plain)));
}

TEST_F(PostFrameTest, motionBlurFollowsTheCameraAndForgetsCuts) {
    frame::FrameSettings s = settings(false, false);
    frame::Frame plain(device(), *onGpu, s);
    s.post.shutter = 1;
    frame::Frame frame(device(), *onGpu, s);
    const scene::Camera moved = scene::orbited(camera, camera.at, 0.03f);
    plain.render(moved, {});
    const auto sharp = radianceOf(plain);
    frame.render(camera, {});
    frame.render(moved, {.postRates = {4, 4, 4}});
    EXPECT_GT(distance(radianceOf(frame), sharp), 5e-4);
    frame.render(moved, {});  // still now
    EXPECT_LT(distance(radianceOf(frame), sharp), 1e-4);
    frame.render(camera, {});
    frame.reset();
    frame.render(moved, {});
    EXPECT_LT(distance(radianceOf(frame), sharp), 1e-4);
    s.captureSide = 2;
    EXPECT_THROW(frame::Frame(device(), *onGpu, s), std::invalid_argument);
}

TEST_F(PostFrameTest, downsampledInputsAreThereToCompareWith) {
    frame::Frame frame(device(), *onGpu, settings(true, true));
    frame.render(camera, {});
    const auto fine = radianceOf(frame);
    frame::FrameSettings s = settings(true, true);
    s.post.downsampled = true;
    s.post.bilateral = false;
    frame::Frame reference(device(), *onGpu, s);
    for (const std::uint32_t rate : {1u, 4u, 16u, 64u}) {
        reference.render(camera, {.postRates = {rate, rate, rate}});
        EXPECT_LT(distance(radianceOf(reference), fine), 0.05) << rate;
    }
    s.supersample = 2;
    EXPECT_THROW(frame::Frame(device(), *onGpu, s), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::post

// SPDX-License-Identifier: Apache-2.0
// Motion vectors rebuilt from visibility, against the points they are of.
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {
namespace {

using scene::Camera;

class MotionTest : public GpuTest {
protected:
    static constexpr vk::Extent2D kSize{72, 48};
    static constexpr float kAspect = 1.5f;

    static FrameSettings settings() {
        FrameSettings s{.size = kSize, .shadowMapSize = 64, .skyViews = 0, .motion = true};
        s.shadowTaps = 0;
        return s;
    }
    static glm::dmat4 clipOf(const Camera& camera) {
        return glm::dmat4(camera.clipFromView(kAspect)) * glm::dmat4(camera.viewFromWorld());
    }
    struct Read {
        vk::Extent2D size;
        std::vector<glm::vec4> motion;
        std::vector<float> depth;
    };
    static Read read(const Frame& frame) {
        return {frame.grid(), gpu::as<glm::vec4>(gpu::readImage(device(), frame.motion())),
                gpu::as<float>(gpu::readImage(device(), frame.depth()))};
    }
    /// Where a pixel's surface is, from its depth alone.
    static glm::dvec3 pointAt(const Camera& camera, const Read& r, std::size_t i, double depth) {
        const glm::dvec2 pixel(i % r.size.width, i / r.size.width);
        const glm::dvec2 ndc = (pixel + 0.5) / glm::dvec2(r.size.width, r.size.height) * 2.0 - 1.0;
        const glm::dmat4 clipFromView(camera.clipFromView(kAspect));
        const glm::dvec4 view(ndc.x * depth / clipFromView[0][0],
                              ndc.y * depth / clipFromView[1][1], -depth, 1);
        return glm::dvec3(glm::inverse(glm::dmat4(camera.viewFromWorld())) * view);
    }
    /// Motion [pixels] of a point that was at `before` under `then`.
    static glm::dvec2 expected(const Camera& then, glm::dvec3 before, const Read& r,
                               std::size_t i) {
        const glm::dvec4 clip = clipOf(then) * glm::dvec4(before, 1);
        const glm::dvec2 size(r.size.width, r.size.height);
        const glm::dvec2 was = (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * size;
        return was - (glm::dvec2(i % r.size.width, i / r.size.width) + 0.5);
    }
    static glm::dvec2 inPixels(const Read& r, std::size_t i) {
        return glm::dvec2(r.motion[i]) * glm::dvec2(r.size.width, r.size.height);
    }
};

TEST_F(MotionTest, nothingMovesWhenNothingMoves) {
    const scene::Scene source = small_scenes::jumble();
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settings());
    const Camera camera = scene::frame(onGpu.bounds(), kAspect);
    for (int i = 0; i < 3; ++i) {
        frame.render(camera, {});
        const Read r = read(frame);
        for (std::size_t p = 0; p < r.motion.size(); ++p) {
            ASSERT_LT(glm::length(inPixels(r, p)), 1e-3);
            ASSERT_NEAR(r.motion[p].z, r.depth[p], 1e-4 * r.depth[p]);
            ASSERT_EQ(r.motion[p].w > 0, r.depth[p] > 0);
        }
    }
}

TEST_F(MotionTest, aMovingCameraMovesEveryPointAsItIsSeen) {
    const scene::Scene source = small_scenes::jumble();
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settings());
    const Camera a = scene::frame(onGpu.bounds(), kAspect);
    Camera b = scene::orbited(a, a.at, 0.03f);
    b.eye += glm::vec3(0.1f, -0.05f, 0.2f);
    for (const float scale : {1.0f, 0.5f, 0.71f}) {
        frame.reset();
        frame.render(a, {.renderScale = 1});
        frame.render(b, {.renderScale = scale});
        const Read r = read(frame);
        int surfaces = 0;
        for (std::size_t i = 0; i < r.motion.size(); ++i) {
            // The sky has no distance: a far point stands for it.
            const bool sky = r.depth[i] == 0;
            const double depth = sky ? 1e7 : r.depth[i];
            const glm::dvec2 wanted = expected(a, pointAt(b, r, i, depth), r, i);
            ASSERT_NEAR(inPixels(r, i).x, wanted.x, 2e-3) << i;
            ASSERT_NEAR(inPixels(r, i).y, wanted.y, 2e-3) << i;
            surfaces += !sky;
            if (sky) continue;
            const glm::dvec4 then =
                glm::dmat4(a.viewFromWorld()) * glm::dvec4(pointAt(b, r, i, depth), 1);
            ASSERT_NEAR(r.motion[i].z, -then.z, 1e-4 * depth);
        }
        EXPECT_GT(surfaces, 250 * scale * scale);
    }
}

TEST_F(MotionTest, anAnimatedNodeMovesAndTheRestStays) {
    scene::Scene source = small_scenes::single(small_scenes::quad());
    small_scenes::place(source, 0, glm::translate(glm::mat4(1), glm::vec3(2.2f, 0, 0)));
    source.nodes[source.instances[0].node] = {};
    scene::Animation animation{.duration = 1};
    animation.channels.push_back({source.instances[0].node,
                                  scene::AnimationPath::translation,
                                  scene::Interpolation::linear,
                                  {0, 1},
                                  {{0, 0, 0, 0}, {-1, 0.5f, -2, 0}}});
    source.animations.push_back(animation);
    scene::GpuScene onGpu(device(), source);
    const Camera camera{.eye = {1, 0, 6}, .at = {1, 0, 0}};
    Frame frame(device(), onGpu, settings());
    onGpu.animate(0.2f);
    frame.render(camera, {});
    onGpu.animate(0.5f);
    frame.render(camera, {});
    const Read r = read(frame);
    const glm::dvec3 moved = 0.3 * glm::dvec3(-1, 0.5, -2);
    int movers = 0, still = 0;
    for (std::size_t i = 0; i < r.motion.size(); ++i) {
        const bool mover = r.motion[i].w == 1;
        const double depth = r.depth[i] > 0 ? r.depth[i] : 1e7;
        const glm::dvec3 now = pointAt(camera, r, i, depth);
        const glm::dvec2 wanted = expected(camera, mover ? now - moved : now, r, i);
        ASSERT_NEAR(glm::distance(inPixels(r, i), wanted), 0, 2e-3) << i;
        movers += mover;
        still += r.motion[i].w == 2;
    }
    EXPECT_GT(movers, 50);
    EXPECT_GT(still, 50);
    // Standing still again it has no motion left over.
    frame.render(camera, {});
    for (const glm::vec4 motion : read(frame).motion)
        ASSERT_LT(glm::length(glm::vec2(motion)), 1e-5);
}

TEST_F(MotionTest, aCutLeavesNoMotion) {
    const scene::Scene source = small_scenes::jumble();
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settings());
    const Camera a = scene::frame(onGpu.bounds(), kAspect);
    frame.render(a, {});
    frame.reset();
    frame.render(scene::orbited(a, a.at, 1), {});
    for (const glm::vec4 motion : read(frame).motion)
        ASSERT_LT(glm::length(glm::vec2(motion)), 1e-5);
}

}  // namespace
}  // namespace lodestar::frame

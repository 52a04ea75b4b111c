// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/motion_tracker.hpp>

namespace lodestar::frame {

using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

MotionTracker::MotionTracker(const gpu::Device& device, const scene::GpuScene& scene,
                             vk::Extent2D room)
    : pass(device, scene.deforms()),
      image(device, {.name = "motion",
                     .format = vk::Format::eR32G32B32A32Sfloat,
                     .extent = room,
                     .usage = Usage::eSampled | Usage::eStorage | Usage::eTransferSrc}),
      instances(device, "previous instances", scene.instances.buffer().bytes(),
                vk::Format::eR32G32B32A32Uint),
      vertices(device, "previous vertices",
               (scene.vertexCount() - scene.firstDeformed()) * sizeof(shared::GpuVertex),
               vk::Format::eR32G32B32A32Uint) {}

void MotionTracker::record(gpu::Recorder& rec, const scene::GpuScene& scene, gpu::View ids,
                           const gpu::Buffer& view, const glm::mat4& clipFromWorld) {
    const bool animated = !known || version != scene.version();
    anyMoved = known && (animated || previousClip != clipFromWorld);
    const gpu::TexelBuffer& before = known ? instances : scene.instances;
    pass.record(rec, scene,
                {ids, view, before, known && scene.deforms() ? &vertices : nullptr,
                 known ? previousClip : clipFromWorld},
                part(image, ids.extent));
    rec.barrier(Stage::compute, Stage::compute);
    if (animated) {
        rec.barrier(Stage::compute, Stage::transfer);
        rec.copy(scene.instances.buffer(), instances.buffer(), instances.buffer().bytes());
        if (scene.deforms())
            rec.copy(scene.vertices.buffer(), vertices.buffer(), vertices.buffer().bytes(),
                     scene.firstDeformed() * sizeof(shared::GpuVertex));
        rec.barrier(Stage::transfer, Stage::compute);
    }
    previousClip = clipFromWorld;
    version = scene.version();
    known = true;
}

}  // namespace lodestar::frame

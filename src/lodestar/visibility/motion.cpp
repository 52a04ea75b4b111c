// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/motion_params.h>
#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/visibility/motion.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/visibility/motion.comp.inc>
    ;

using gpu::Slot;

}  // namespace

Motion::Motion(const gpu::Device& device, bool deforms)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "motion", kCode,
             scene::withSceneSlots({Slot::uniformBuffer, Slot::sampledImage, Slot::storageImage,
                                    Slot::texelBuffer, Slot::texelBuffer}),
             sizeof(shared::MotionParams), {deforms ? 1u : 0u}) {}

void Motion::record(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                    gpu::View motion) const {
    const auto pass = rec.pass("motion");
    const gpu::TexelBuffer& vertices = in.previousVertices ? *in.previousVertices : scene.vertices;
    rec.dispatch(
        kernel, gpu::groups8x8(in.ids.extent),
        scene::withScene(scene,
                         {in.view, {in.ids, pointSampler}, motion, in.previousInstances, vertices}),
        shared::MotionParams{
            .previousClipFromWorld = in.previousClipFromWorld,
            .size = {in.ids.extent.width, in.ids.extent.height},
            .firstDeformed = in.previousVertices ? scene.firstDeformed() : scene.vertexCount()});
}

}  // namespace lodestar::visibility

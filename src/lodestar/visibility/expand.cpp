// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/expand.hpp>

#include <lodestar/visibility/expand_params.h>
#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/visibility/expand.comp.inc>
    ;

using gpu::Slot;

gpu::Kernel makeKernel(const gpu::Device& device, std::uint32_t side, std::uint32_t mode) {
    return {device,
            "expand",
            kCode,
            scene::withSceneSlots({Slot::texelBuffer, Slot::texelBuffer, Slot::storageImage}),
            sizeof(shared::ExpandParams),
            {side, mode}};
}

/// Whether the centre of every pixel of O is the centre of a sample of C, along one axis: C is an
/// odd multiple of O.
bool onSample(std::uint32_t samples, std::uint32_t pixels) {
    return samples % pixels == 0 && samples / pixels % 2 == 1;
}

}  // namespace

Expand::Expand(const gpu::Device& device, std::uint32_t s)
    : side(s),
      kernels{makeKernel(device, s, onSamples), makeKernel(device, s, byEdges),
              makeKernel(device, s, representatives)} {}

void Expand::record(gpu::Recorder& rec, const scene::GpuScene& scene, const CompactRecord& from,
                    const glm::mat4& clipFromWorld, gpu::View ids) const {
    const bool exact = onSample(from.base.width * side, ids.extent.width) &&
                       onSample(from.base.height * side, ids.extent.height);
    recordMode(rec, exact ? onSamples : byEdges, scene, from, clipFromWorld, ids);
}

void Expand::recordRepresentatives(gpu::Recorder& rec, const scene::GpuScene& scene,
                                   const CompactRecord& from, gpu::View ids) const {
    if (ids.extent != from.base)
        throw std::invalid_argument("Expand::recordRepresentatives: ids is not of grid B");
    recordMode(rec, representatives, scene, from, glm::mat4(1), ids);
}

void Expand::recordMode(gpu::Recorder& rec, Mode mode, const scene::GpuScene& scene,
                        const CompactRecord& from, const glm::mat4& clipFromWorld,
                        gpu::View ids) const {
    if (from.side != side) throw std::invalid_argument("Expand: record of another rate");
    const auto pass = rec.pass("expand");
    rec.dispatch(kernels[mode], gpu::groups8x8(ids.extent),
                 scene::withScene(scene, {from.heads, from.lists, ids}),
                 shared::ExpandParams{
                     .clipFromWorld = clipFromWorld,
                     .base = {from.base.width, from.base.height},
                     .size = {ids.extent.width, ids.extent.height},
                     .maskedFrom = scene.wholeBinStarts()[std::size_t(scene::DrawBin::masked)]});
}

}  // namespace lodestar::visibility

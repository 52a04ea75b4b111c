// SPDX-License-Identifier: Apache-2.0
#include <lodestar/geometry/cull.hpp>
#include <lodestar/geometry/cull_params.h>
#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::geometry {
namespace {

constexpr std::uint32_t kCullCode[] =
#include <lodestar/geometry/cull.comp.inc>
    ;
constexpr std::uint32_t kEmitCode[] =
#include <lodestar/geometry/emit.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

glm::vec4 normalised(glm::vec4 plane) { return plane / glm::length(glm::vec3(plane)); }

/// Gribb & Hartmann 2001: the planes of a projection are sums of its rows.
shared::CullParams cullParams(const CullView& view, std::uint32_t clusters) {
    const glm::mat4 rows = glm::transpose(view.clipFromWorld);
    shared::CullParams params{.eye = view.eye,
                              .clusterCount = clusters,
                              .useCones = view.perspective ? 1u : 0u};
    params.planes[0] = normalised(rows[3] + rows[0]);
    params.planes[1] = normalised(rows[3] - rows[0]);
    params.planes[2] = normalised(rows[3] + rows[1]);
    params.planes[3] = normalised(rows[3] - rows[1]);
    params.planes[4] =
        view.keepBeforeNear ? glm::vec4(0, 0, 0, 1) : normalised(rows[3] - rows[2]);
    return params;
}

}  // namespace

DrawList::DrawList(const gpu::Device& device, const scene::GpuScene& scene, const std::string& name)
    : offsets(device, name + ": offsets",
              4ull * gpu::PrefixSum::bufferLength(scene.clusterCount() + 1)),
      indices(device, name + ": indices", 12ull * scene.triangleCount()),
      ids(device, name + ": triangle ids", 4ull * scene.triangleCount(),
          vk::Format::eR32Uint),
      draws(device, name + ": draws", scene::kDrawBins * sizeof(vk::DrawIndexedIndirectCommand)) {}

Cull::Cull(const gpu::Device& device)
    : cull(device, "cull", kCullCode, scene::withSceneSlots({Slot::storageBuffer}),
           sizeof(shared::CullParams)),
      emit(device, "emit", kEmitCode,
           scene::withSceneSlots({Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer,
                                  Slot::storageBuffer}),
           sizeof(shared::EmitParams)),
      prefixSum(device) {}

void Cull::record(gpu::Recorder& rec, const scene::GpuScene& scene, const CullView& view,
                  DrawList& list) const {
    const auto pass = rec.pass("cull");
    const std::uint32_t clusters = scene.clusterCount();
    rec.dispatch(cull, {gpu::groups(clusters + 1, 64), 1, 1},
                 scene::withScene(scene, {list.offsets}), cullParams(view, clusters));
    rec.barrier(Stage::compute, Stage::compute);
    prefixSum.record(rec, list.offsets, clusters + 1);
    shared::EmitParams params{};
    for (std::size_t i = 0; i <= scene::kDrawBins; ++i) params.binStarts[i] = scene.binStarts()[i];
    const std::uint32_t rows = gpu::groups(clusters, 32768);
    rec.dispatch(emit, {gpu::groups(clusters, rows), rows, 1},
                 scene::withScene(scene, {list.offsets, list.indices, list.ids.buffer(), list.draws}),
                 params);
}

}  // namespace lodestar::geometry

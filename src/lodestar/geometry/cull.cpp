// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <lodestar/geometry/cull_params.h>
#include <lodestar/geometry/cull.hpp>
#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::geometry {
namespace {

constexpr std::uint32_t kClustersCode[] =
#include <lodestar/geometry/cull_clusters.comp.inc>
    ;
constexpr std::uint32_t kCompactCode[] =
#include <lodestar/geometry/compact.comp.inc>
    ;
constexpr std::uint32_t kTrianglesCode[] =
#include <lodestar/geometry/cull_triangles.comp.inc>
    ;
constexpr std::uint32_t kEmitCode[] =
#include <lodestar/geometry/emit.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

glm::vec4 normalised(glm::vec4 plane) {
    return plane / glm::length(glm::vec3(plane));
}

/// Gribb & Hartmann 2001: the planes of a projection are sums of its rows.
shared::CullClustersParams clusterParams(const CullView& view, std::uint32_t clusters) {
    const glm::mat4 rows = glm::transpose(view.clipFromWorld);
    shared::CullClustersParams params{
        .eye = view.eye, .clusterCount = clusters, .useCones = view.perspective ? 1u : 0u};
    params.planes[0] = normalised(rows[3] + rows[0]);
    params.planes[1] = normalised(rows[3] - rows[0]);
    params.planes[2] = normalised(rows[3] + rows[1]);
    params.planes[3] = normalised(rows[3] - rows[1]);
    params.planes[4] = view.keepBeforeNear ? glm::vec4(0, 0, 0, 1) : normalised(rows[3] - rows[2]);
    return params;
}

std::vector<gpu::SlotArray> storageSlots(std::size_t count) {
    return std::vector<gpu::SlotArray>(count, Slot::storageBuffer);
}

}  // namespace

DrawList::DrawList(const gpu::Device& device, const scene::GpuScene& scene, const std::string& name)
    : clusterOffsets(device, name + ": cluster offsets",
                     4ull * gpu::PrefixSum::bufferLength(scene.clusterCount() + 1)),
      visible(device, name + ": visible clusters", 4ull * scene.clusterCount()),
      counts(device, name + ": counts", sizeof(shared::VisibleCounts)),
      masks(device, name + ": triangle masks", 16ull * scene.clusterCount()),
      triangleOffsets(device, name + ": triangle offsets",
                      4ull * gpu::PrefixSum::bufferLength(scene.clusterCount() + 1)),
      ids(device, name + ": triangle ids", 4ull * scene.triangleCount(), vk::Format::eR32Uint),
      draws(device, name + ": draws", scene::kDrawBins * sizeof(vk::DrawIndirectCommand)) {}

Cull::Cull(const gpu::Device& device)
    : clusters(device, "cull clusters", kClustersCode, scene::withSceneSlots(storageSlots(1)),
               sizeof(shared::CullClustersParams)),
      compact(device, "compact clusters", kCompactCode, storageSlots(5),
              sizeof(shared::CompactParams)),
      triangles(device, "cull triangles", kTrianglesCode, scene::withSceneSlots(storageSlots(4)),
                sizeof(shared::CullTrianglesParams)),
      emit(device, "emit", kEmitCode, storageSlots(6)),
      prefixSum(device) {}

void Cull::record(gpu::Recorder& rec, const scene::GpuScene& scene, const CullView& view,
                  DrawList& list) const {
    if (view.size.width == 0 || view.size.height == 0)
        throw std::invalid_argument("CullView::size is 0");
    const auto pass = rec.pass("cull");
    const std::uint32_t count = scene.clusterCount();
    const vk::Extent3D oneAThread{gpu::groups(count + 1, 64), 1, 1};

    rec.dispatch(clusters, oneAThread, scene::withScene(scene, {list.clusterOffsets}),
                 clusterParams(view, count));
    rec.barrier(Stage::compute, Stage::compute);
    prefixSum.record(rec, list.clusterOffsets, count + 1);

    shared::CompactParams bins{};
    std::copy(scene.binStarts().begin(), scene.binStarts().end(), bins.binStarts);
    rec.dispatch(compact, oneAThread,
                 {list.clusterOffsets, list.visible, list.triangleOffsets, list.masks, list.counts},
                 bins);
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::indirect);

    shared::CullTrianglesParams params{
        .clipFromWorld = view.clipFromWorld,
        .size = {static_cast<float>(view.size.width), static_cast<float>(view.size.height)}};
    std::copy(scene.binStarts().begin(), scene.binStarts().end(), params.binStarts);
    rec.dispatchIndirect(
        triangles, list.counts,
        scene::withScene(scene, {list.visible, list.counts, list.masks, list.triangleOffsets}),
        params);
    rec.barrier(Stage::compute, Stage::compute);
    prefixSum.record(rec, list.triangleOffsets, count + 1);

    rec.dispatchIndirect(emit, list.counts,
                         {list.visible, list.counts, list.masks, list.triangleOffsets,
                          list.ids.buffer(), list.draws});
}

}  // namespace lodestar::geometry

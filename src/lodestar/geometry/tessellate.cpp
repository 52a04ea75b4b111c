// SPDX-License-Identifier: Apache-2.0
#include <lodestar/geometry/tessellate.hpp>

#include <limits>
#include <numbers>

#include <lodestar/geometry/tessellate_params.h>
#include <lodestar/geometry/frustum.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::geometry {
namespace {

constexpr std::uint32_t kSelectCode[] =
#include <lodestar/geometry/tessellate_select.comp.inc>
    ;
constexpr std::uint32_t kListCode[] =
#include <lodestar/geometry/tessellate_list.comp.inc>
    ;
constexpr std::uint32_t kRefineCode[] =
#include <lodestar/geometry/tessellate_refine.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using shared::TessellateHeader;

std::vector<gpu::SlotArray> selectSlots() {
    return scene::withSceneSlots({Slot::uniformBuffer, Slot::texelBuffer, Slot::texelBuffer,
                                  Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer});
}

std::uint64_t offsetBytes(const scene::GpuScene& scene) {
    return 4ull * gpu::PrefixSum::bufferLength(scene.relief.pairCount);
}

}  // namespace

Tessellate::Tessellate(const gpu::Device& d, const scene::GpuScene& scene)
    : device(&d),
      count(d, "tessellate: count", kSelectCode, selectSlots(), 0, {0}),
      mark(d, "tessellate: mark", kSelectCode, selectSlots(), 0, {1}),
      list(d, "tessellate: list", kListCode,
           scene::withSceneSlots({Slot::uniformBuffer, Slot::texelBuffer, Slot::texelBuffer,
                                  Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer,
                                  Slot::storageBuffer, Slot::storageBuffer})),
      refine(d, "tessellate: refine", kRefineCode,
             scene::withSceneSlots({Slot::uniformBuffer, Slot::texelBuffer, Slot::texelBuffer,
                                    Slot::texelBuffer, Slot::storageBuffer, Slot::storageBuffer,
                                    Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer,
                                    Slot::storageBuffer, Slot::storageBuffer})),
      prefixSum(d),
      params(d, "tessellation", sizeof(shared::TessellateParams)),
      offsets(d, "refined triangles before each meshlet", offsetBytes(scene)),
      entries(d, "triangles to refine", 8ull * scene.relief.capacity),
      header(d, "tessellation: counts", sizeof(TessellateHeader)),
      capacity(scene.relief.capacity) {}

void Tessellate::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                        const CullView& view) const {
    const scene::Relief& relief = scene.relief;
    if (relief.capacity == 0 || view.wavePx == 0) return;
    const auto pass = rec.pass("tessellate");
    const auto planes = frustumPlanes(view.clipFromWorld, view.keepBeforeNear);
    shared::TessellateParams p{.eye = view.eye,
                               .reach = pixelsPerUnit(view) / view.wavePx,
                               .pairs = relief.pairCount,
                               .capacity = relief.capacity,
                               .total = gpu::PrefixSum::bufferLength(relief.pairCount) - 1,
                               .firstVertex = relief.firstVertex,
                               .firstTriangle = relief.firstTriangle,
                               .firstMeshlet = relief.firstMeshlet,
                               .firstListed = relief.firstListed,
                               .secondUvs = scene.features().secondUvs};
    std::copy(planes.begin(), planes.end(), p.planes);
    rec.barrier(Stage::compute, Stage::transfer);
    rec.barrier(Stage::indirect, Stage::transfer);
    rec.update(params, p);
    rec.update(header, TessellateHeader{});
    rec.barrier(Stage::transfer, Stage::compute);

    const vk::Extent3D overPairs{gpu::groups(relief.pairCount, shared::LS_SPAN), 1, 1};
    const auto select = scene::withScene(
        scene, {params, relief.displaced, relief.pairs, header, relief.masks.buffer(), offsets});
    rec.dispatch(count, overPairs, select);
    rec.barrier(Stage::compute, Stage::compute);
    rec.dispatch(mark, overPairs, select);
    rec.barrier(Stage::compute, Stage::compute);
    prefixSum.record(rec, offsets, relief.pairCount);
    rec.dispatch(
        list, overPairs,
        scene::withScene(scene, {params, relief.displaced, relief.pairs, relief.masks.buffer(),
                                 offsets, entries, relief.refined.buffer(), header}));
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::indirect);
    rec.dispatchIndirect(
        refine, header,
        scene::withScene(
            scene, {params, relief.displaced, relief.pairs, scene.secondUvs, header, entries,
                    scene.vertices.buffer(), scene.attributes.buffer(), scene.secondUvs.buffer(),
                    scene.triangles.buffer(), scene.meshlets.buffer()}));
    rec.barrier(Stage::compute, Stage::compute);
}

float Tessellate::coarsenedBy() const {
    const auto counts =
        gpu::as<TessellateHeader>(gpu::readBuffer(*device, header, sizeof(TessellateHeader)));
    float factor = 1;
    for (const std::uint32_t within : counts.front().within) {
        if (within <= capacity) return factor;
        factor *= std::numbers::sqrt2_v<float>;
    }
    return std::numeric_limits<float>::infinity();
}

}  // namespace lodestar::geometry

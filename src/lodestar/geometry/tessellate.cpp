// SPDX-License-Identifier: Apache-2.0
#include <lodestar/geometry/tessellate.hpp>

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

std::uint64_t offsetBytes(const scene::GpuScene& scene) {
    return 4ull * gpu::PrefixSum::bufferLength(scene.relief.pairCount);
}

}  // namespace

Tessellate::Tessellate(const gpu::Device& d, const scene::GpuScene& scene)
    : device(&d),
      select(d, "tessellate: select", kSelectCode,
             scene::withSceneSlots({Slot::uniformBuffer, Slot::texelBuffer, Slot::texelBuffer,
                                    Slot::storageBuffer, Slot::storageBuffer})),
      list(d, "tessellate: list", kListCode,
           scene::withSceneSlots({Slot::uniformBuffer, Slot::texelBuffer, Slot::texelBuffer,
                                  Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer,
                                  Slot::storageBuffer, Slot::storageBuffer})),
      refine(d, "tessellate: refine", kRefineCode,
             scene::withSceneSlots({Slot::uniformBuffer, Slot::texelBuffer, Slot::texelBuffer,
                                    Slot::texelBuffer, Slot::storageBuffer, Slot::storageBuffer,
                                    Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer,
                                    Slot::storageBuffer})),
      prefixSum(d),
      params(d, "tessellation", sizeof(shared::TessellateParams)),
      offsets(d, "refined triangles before each meshlet", offsetBytes(scene)),
      entries(d, "triangles to refine", 8ull * scene.relief.capacity),
      header(d, "tessellation: counts", sizeof(TessellateHeader)) {}

void Tessellate::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                        const CullView& view) const {
    const scene::Relief& relief = scene.relief;
    if (relief.capacity == 0 || view.edgePx == 0) return;
    const auto pass = rec.pass("tessellate");
    const auto planes = frustumPlanes(view.clipFromWorld, view.keepBeforeNear);
    shared::TessellateParams p{.eye = view.eye,
                               .reach = pixelsPerUnit(view.clipFromWorld, view.size) / view.edgePx,
                               .pairs = relief.pairCount,
                               .instances = relief.instances,
                               .capacity = relief.capacity,
                               .total = gpu::PrefixSum::bufferLength(relief.pairCount) - 1,
                               .firstVertex = relief.firstVertex,
                               .firstTriangle = relief.firstTriangle,
                               .firstMeshlet = relief.firstMeshlet,
                               .secondUvs = scene.features().secondUvs};
    std::copy(planes.begin(), planes.end(), p.planes);
    rec.barrier(Stage::compute, Stage::transfer);
    rec.update(params, p);
    rec.barrier(Stage::transfer, Stage::compute);

    const vk::Extent3D overPairs{gpu::groups(relief.pairCount, shared::LS_SPAN), 1, 1};
    rec.dispatch(select, overPairs,
                 scene::withScene(scene, {params, relief.displaced, relief.pairs,
                                          relief.masks.buffer(), offsets}));
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
            scene, {params, relief.displaced, relief.pairs, scene.secondUvs, entries,
                    scene.vertices.buffer(), scene.attributes.buffer(), scene.secondUvs.buffer(),
                    scene.triangles.buffer(), scene.meshlets.buffer()}));
    rec.barrier(Stage::compute, Stage::compute);
}

std::uint32_t Tessellate::dropped() const {
    return gpu::as<TessellateHeader>(gpu::readBuffer(*device, header, sizeof(TessellateHeader)))
        .front()
        .dropped;
}

}  // namespace lodestar::geometry

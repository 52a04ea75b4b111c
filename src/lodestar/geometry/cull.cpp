// SPDX-License-Identifier: Apache-2.0
#include <lodestar/geometry/cull.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

#include <lodestar/geometry/project_params.h>
#include <lodestar/geometry/frustum.hpp>
#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::geometry {
namespace {

constexpr std::uint32_t kChunksCode[] =
#include <lodestar/geometry/cull_chunks.comp.inc>
    ;
constexpr std::uint32_t kListChunksCode[] =
#include <lodestar/geometry/list_chunks.comp.inc>
    ;
constexpr std::uint32_t kInstancesCode[] =
#include <lodestar/geometry/cull_instances.comp.inc>
    ;
constexpr std::uint32_t kClustersCode[] =
#include <lodestar/geometry/cull_clusters.comp.inc>
    ;
constexpr std::uint32_t kCompactCode[] =
#include <lodestar/geometry/compact.comp.inc>
    ;
constexpr std::uint32_t kProjectCode[] =
#include <lodestar/geometry/project.comp.inc>
    ;
constexpr std::uint32_t kTrianglesCode[] =
#include <lodestar/geometry/cull_triangles.comp.inc>
    ;
constexpr std::uint32_t kEmitCode[] =
#include <lodestar/geometry/emit.comp.inc>
    ;
constexpr std::uint32_t kScanBlocksCode[] =
#include <lodestar/geometry/scan_blocks.comp.inc>
    ;
constexpr std::uint32_t kScanTotalsCode[] =
#include <lodestar/geometry/scan_totals.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using shared::CullList;
using shared::ScanParams;

constexpr auto kUint = vk::Format::eR32Uint;

struct TotalledPhase {
    shared::PhaseParams phase;
    std::uint32_t totals;
};

/// Words of a buffer of values to scan: the values, then the totals of their blocks.
std::uint64_t scanBytes(std::uint64_t values) {
    return 4 * (values + values / shared::LS_BLOCK + 1);
}

void setLods(const CullView& view, shared::CullParams& params) {
    const LodChoice& lod = view.lod;
    if (lod.distances.size() > 8)
        throw std::invalid_argument("LodChoice::distances has more than 8 entries");
    if (lod.mode == LodChoice::Mode::error && !(lod.errorPx > 0))
        throw std::invalid_argument("LodChoice::errorPx must be above 0");
    params.lodMode = static_cast<std::uint32_t>(lod.mode);
    params.lodEye = view.eye;
    params.lodParallel = !view.perspective;
    params.lodScale = pixelsPerUnit(view) / lod.errorPx;
    float begins[8];
    std::fill(std::begin(begins), std::end(begins), std::numeric_limits<float>::infinity());
    std::copy(lod.distances.begin(), lod.distances.end(), begins);
    params.distances0 = {begins[0], begins[1], begins[2], begins[3]};
    params.distances1 = {begins[4], begins[5], begins[6], begins[7]};
}

shared::CullParams paramsOf(const CullView& view, const scene::GpuScene& scene, const HiZ* hiz) {
    shared::CullParams params{
        .clipFromWorld = view.clipFromWorld,
        .eye = view.eye,
        .mode = static_cast<std::uint32_t>(view.cull),
        .size = {static_cast<float>(view.size.width), static_cast<float>(view.size.height)},
        .useCones = view.perspective,
        .chunkCount = scene.chunkCount()};
    const auto planes = frustumPlanes(view.clipFromWorld, view.keepBeforeNear);
    std::copy(planes.begin(), planes.end(), params.planes);
    setLods(view, params);
    if (view.wavePx > 0 && scene.relief.capacity > 0)
        params.reliefReach = pixelsPerUnit(view) / view.wavePx;
    if (hiz != nullptr) {
        params.hizFromWorld0 = hiz->clipFromWorld();
        params.hizFromWorld1 = view.clipFromWorld;
        params.hizValid = hiz->valid();
        params.hizSize = {static_cast<float>(hiz->size().width),
                          static_cast<float>(hiz->size().height)};
        params.hizLevels = static_cast<std::uint32_t>(hiz->levels().size()) + shared::LS_HIZ_FIRST;
        for (std::size_t i = 0; i < hiz->levels().size(); ++i)
            params.hizOffsets[i + shared::LS_HIZ_FIRST] = hiz->levels()[i].offset;
    }
    return params;
}

std::vector<gpu::SlotArray> slots(std::initializer_list<std::pair<Slot, int>> runs) {
    std::vector<gpu::SlotArray> all;
    for (const auto& [slot, count] : runs)
        for (int i = 0; i < count; ++i) all.emplace_back(slot);
    return all;
}

constexpr std::uint64_t kGroups = offsetof(CullList, groups), kBlocks = offsetof(CullList, blocks),
                        kWords = offsetof(CullList, words);

/// Where the dispatch over a list stands in DrawList::counts.
constexpr std::uint64_t at(std::uint32_t list, std::uint64_t which) {
    return offsetof(shared::CullCounts, lists) + list * sizeof(CullList) + which;
}

gpu::Kernel makeCullTriangles(const gpu::Device& device, bool projected) {
    return {device,
            projected ? "cull projected triangles" : "cull triangles",
            kTrianglesCode,
            scene::withSceneSlots(slots({{Slot::uniformBuffer, 1},
                                         {Slot::texelBuffer, 2},
                                         {Slot::storageBuffer, 3},
                                         {Slot::texelBuffer, 1}})),
            sizeof(shared::ProjectParams),
            {projected}};
}

}  // namespace

float pixelsPerUnit(const CullView& view) {
    return pixelsPerUnit(view.clipFromWorld, view.shown.value_or(view.size));
}

DrawList::DrawList(const gpu::Device& device, const scene::GpuScene& scene, const std::string& name,
                   scene::TablePart ofTable, std::uint32_t projects)
    : ids(device, name + ": triangle ids", 4ull * scene.triangleCapacity(), kUint),
      draws(device, name + ": draws", 2 * scene::kDrawBins * sizeof(vk::DrawIndirectCommand)),
      counts(device, name + ": counts", sizeof(shared::CullCounts)),
      projected(device, name + ": projected vertices",
                8ull * shared::LS_MESHLET_VERTICES * std::min(scene.clusterCapacity(), projects),
                vk::Format::eR32G32Uint),
      projectedDepths(
          device, name + ": depths of projected vertices",
          4ull * shared::LS_MESHLET_VERTICES * std::min(scene.clusterCapacity(), projects),
          vk::Format::eR32Sfloat),
      projectedClusters(std::min(scene.clusterCapacity(), projects)),
      params(device, name + ": view", sizeof(shared::CullParams)),
      chunkOffsets(device, name + ": chunk offsets", scanBytes(scene.chunkCount())),
      chunks(device, name + ": visible chunks", 4ull * scene.chunkCount()),
      firstOffsets(device, name + ": meshlet offsets",
                   scanBytes(std::uint64_t{scene.chunkCount()} * shared::LS_CHUNK), kUint),
      secondOffsets(device, name + ": meshlet offsets, second phase",
                    scanBytes(std::uint64_t{scene.chunkCount()} * shared::LS_CHUNK), kUint),
      states(device, name + ": instance states", 4ull * scene.chunkCount() * shared::LS_CHUNK),
      candidates(device, name + ": meshlets", 8ull * scene.clusterCapacity()),
      candidateOffsets(device, name + ": cluster offsets", scanBytes(scene.clusterCapacity())),
      hidden(device, name + ": hidden meshlets", 4ull * scene.clusterCapacity()),
      masks(device, name + ": triangle masks", 16ull * scene.clusterCapacity()),
      triangleOffsets(device, name + ": triangle offsets", scanBytes(scene.clusterCapacity())),
      chunkCount(scene.chunkCount()),
      instancePlaces(scene.chunkCount() * shared::LS_CHUNK),
      clusterPlaces(scene.clusterCapacity() - 1),
      trianglePlaces(scene.triangleCapacity()),
      part(ofTable),
      table(scene.tableStart(ofTable)) {}

Cull::Cull(const gpu::Device& device)
    : cullChunks(device, "cull chunks", kChunksCode,
                 {Slot::uniformBuffer, Slot::texelBuffer, Slot::storageBuffer}),
      listChunks(device, "list chunks", kListChunksCode,
                 slots({{Slot::uniformBuffer, 1}, {Slot::storageBuffer, 3}}), sizeof(ScanParams)),
      cullInstances(
          device, "cull instances", kInstancesCode,
          scene::withSceneSlots(
              slots({{Slot::uniformBuffer, 1}, {Slot::texelBuffer, 7}, {Slot::storageBuffer, 4}})),
          sizeof(shared::PhaseParams)),
      cullClusters(
          device, "cull clusters", kClustersCode,
          scene::withSceneSlots(
              slots({{Slot::uniformBuffer, 1}, {Slot::texelBuffer, 6}, {Slot::storageBuffer, 5}})),
          sizeof(TotalledPhase)),
      compact(device, "compact clusters", kCompactCode,
              scene::withSceneSlots(slots({{Slot::texelBuffer, 1}, {Slot::storageBuffer, 6}})),
              sizeof(TotalledPhase)),
      project(device, "project", kProjectCode,
              scene::withSceneSlots(slots({{Slot::texelBuffer, 1}, {Slot::storageBuffer, 3}})),
              sizeof(shared::ProjectParams)),
      cullTriangles(makeCullTriangles(device, false)),
      cullProjected(makeCullTriangles(device, true)),
      emit(device, "emit", kEmitCode, slots({{Slot::texelBuffer, 1}, {Slot::storageBuffer, 5}}),
           sizeof(shared::EmitParams)),
      scanBlocks(device, "scan blocks", kScanBlocksCode, slots({{Slot::storageBuffer, 2}}),
                 sizeof(ScanParams)),
      scanTotals(device, "scan totals", kScanTotalsCode, slots({{Slot::storageBuffer, 2}}),
                 sizeof(ScanParams)),
      noPyramid(device, "no hi-z", 16, vk::Format::eR32Sfloat) {}

void Cull::record(gpu::Recorder& rec, const scene::GpuScene& scene, const CullView& view,
                  DrawList& list) const {
    if (view.cull == CullMode::hiz)
        throw std::invalid_argument("Cull::record: CullMode::hiz takes two phases");
    {
        const auto pass = rec.pass("cull");
        start(rec, scene, view, list, nullptr);
        listClusters(rec, scene, list, 0, noPyramid);
    }
    const auto pass = rec.pass("cull triangles");
    listTriangles(rec, scene, list, 0);
}

void Cull::recordFirst(gpu::Recorder& rec, const scene::GpuScene& scene, const CullView& view,
                       DrawList& list, const HiZ& hiz) const {
    {
        const auto pass = rec.pass("cull");
        CullView hidden = view;
        hidden.cull = CullMode::hiz;
        start(rec, scene, hidden, list, &hiz);
        listClusters(rec, scene, list, 0, hiz.pyramid());
    }
    const auto pass = rec.pass("cull triangles");
    listTriangles(rec, scene, list, 0);
}

void Cull::recordSecond(gpu::Recorder& rec, const scene::GpuScene& scene, DrawList& list,
                        const HiZ& hiz) const {
    const auto pass = rec.pass("cull rest");
    rec.barrier(Stage::compute, Stage::compute);
    listClusters(rec, scene, list, 1, hiz.pyramid());
    listTriangles(rec, scene, list, 1);
}

/// Values that `list` counts become what is before each; their total, times `times`, the length of
/// another list.
void Cull::scan(gpu::Recorder& rec, const gpu::Buffer& values, const DrawList& list,
                const ScanParams& params) const {
    rec.barrier(Stage::compute, Stage::compute);
    rec.dispatchIndirect(scanBlocks, list.counts, at(params.source, kBlocks), {values, list.counts},
                         params);
    rec.barrier(Stage::compute, Stage::compute);
    rec.dispatch(scanTotals, {1, 1, 1}, {values, list.counts}, params);
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::indirect);
}

void Cull::start(gpu::Recorder& rec, const scene::GpuScene& scene, const CullView& view,
                 DrawList& list, const HiZ* hiz) const {
    if (view.size.width == 0 || view.size.height == 0)
        throw std::invalid_argument("CullView::size is 0");
    shared::CullParams params = paramsOf(view, scene, hiz);
    if (view.samples && list.projectedClusters == 0)
        throw std::invalid_argument("CullView::samples needs a list with room for vertices");
    list.samples = view.samples;
    params.listAll = list.part == scene::TablePart::whole;
    if (params.reliefReach > 0 && (params.listAll || !view.perspective))
        throw std::invalid_argument("CullView::wavePx is for a perspective view of the eye");
    if (params.listAll && (view.lod.mode != LodChoice::Mode::off || hiz != nullptr))
        throw std::invalid_argument(
            "Cull: a list of the whole table has no levels of detail and no Hi-Z");
    const std::uint32_t count = scene.chunkCount();
    const auto inRows = [](std::uint32_t groups, std::uint32_t* to) {
        const std::uint32_t rows = gpu::groups(groups, 32768);
        to[0] = rows == 0 ? 0 : gpu::groups(groups, rows);
        to[1] = rows;
        to[2] = 1;
    };
    shared::CullCounts counts{};
    CullList& chunks = counts.lists[shared::LS_LIST_CHUNKS];
    chunks.count = count;
    inRows(gpu::groups(count, shared::LS_SPAN), chunks.groups);
    inRows(gpu::groups(count, shared::LS_BLOCK), chunks.blocks);

    rec.barrier(Stage::compute, Stage::transfer);  // a view before may still read them
    rec.barrier(Stage::indirect, Stage::transfer);
    rec.update(list.params, params);
    rec.update(list.counts, counts);
    rec.barrier(Stage::transfer, Stage::compute);
    rec.barrier(Stage::transfer, Stage::indirect);

    const ScanParams ofChunks{.source = shared::LS_LIST_CHUNKS,
                              .result = shared::LS_LIST_INSTANCES,
                              .times = shared::LS_CHUNK,
                              .capacity = list.instancePlaces,
                              .before = shared::LS_LIST_INSTANCES,
                              .totals = list.chunkCount};
    rec.dispatchIndirect(cullChunks, list.counts, at(shared::LS_LIST_CHUNKS, kGroups),
                         {list.params, scene.chunks, list.chunkOffsets});
    scan(rec, list.chunkOffsets, list, ofChunks);
    rec.dispatchIndirect(listChunks, list.counts, at(shared::LS_LIST_CHUNKS, kGroups),
                         {list.params, list.chunkOffsets, list.chunks, list.counts}, ofChunks);
    rec.barrier(Stage::compute, Stage::compute);
}

/// The instances of the visible chunks, then their meshlets: those that are visible go to the
/// scene's table.
void Cull::listClusters(gpu::Recorder& rec, const scene::GpuScene& scene, DrawList& list,
                        std::uint32_t number, const gpu::TexelBuffer& pyramid) const {
    const bool second = number == 1;
    const std::uint32_t candidates =
        second ? shared::LS_LIST_CANDIDATES_2 : shared::LS_LIST_CANDIDATES;
    const std::uint32_t clusters = second ? shared::LS_LIST_CLUSTERS_2 : shared::LS_LIST_CLUSTERS;
    const gpu::TexelBuffer& offsets = second ? list.secondOffsets : list.firstOffsets;
    const shared::PhaseParams phase{.phase = number, .table = list.table};

    rec.dispatchIndirect(
        cullInstances, list.counts, at(shared::LS_LIST_INSTANCES, kGroups),
        scene::withScene(scene, {list.params, scene.chunks, scene.drawOrder, scene.meshes,
                                 scene.lods, pyramid, scene.relief.displaced, scene.relief.refined,
                                 list.chunks, list.counts, offsets.buffer(), list.states}),
        phase);
    scan(rec, offsets.buffer(), list,
         {.source = shared::LS_LIST_INSTANCES,
          .result = candidates,
          .times = 1,
          .capacity = list.clusterPlaces,
          .before = candidates,
          .totals = list.instancePlaces});

    rec.dispatchIndirect(
        cullClusters, list.counts, at(candidates, kGroups),
        scene::withScene(scene, {list.params, scene.lods, scene.meshes, pyramid, offsets,
                                 list.firstOffsets, scene.relief.refined, list.counts, list.states,
                                 list.candidates, list.candidateOffsets, list.hidden}),
        TotalledPhase{phase, list.instancePlaces});
    scan(rec, list.candidateOffsets, list,
         {.source = candidates,
          .result = clusters,
          .times = 1,
          .capacity = list.clusterPlaces,
          .before = second ? shared::LS_LIST_CLUSTERS : clusters,
          .totals = list.clusterPlaces});
    rec.dispatchIndirect(
        compact, list.counts, at(candidates, kGroups),
        scene::withScene(scene, {scene.meshes, list.counts, list.candidates, list.candidateOffsets,
                                 scene.clusters.buffer(), list.triangleOffsets, list.masks}),
        TotalledPhase{phase, list.clusterPlaces});
    rec.barrier(Stage::compute, Stage::compute);
}

/// The triangles of the clusters listed, tested, and the draws of those that remain.
void Cull::listTriangles(gpu::Recorder& rec, const scene::GpuScene& scene, DrawList& list,
                         std::uint32_t number) const {
    const bool second = number == 1;
    const std::uint32_t clusters = second ? shared::LS_LIST_CLUSTERS_2 : shared::LS_LIST_CLUSTERS;
    const std::uint32_t triangles =
        second ? shared::LS_LIST_TRIANGLES_2 : shared::LS_LIST_TRIANGLES;
    const shared::PhaseParams phase{.phase = number, .table = list.table};
    const auto bindings =
        scene::withScene(scene, {list.params, scene.relief.displaced, scene.relief.masks,
                                 list.counts, list.masks, list.triangleOffsets, list.projected});
    shared::ProjectParams params{.phase = number, .table = list.table};
    if (!list.samples) {
        rec.dispatchIndirect(cullTriangles, list.counts, at(clusters, kWords), bindings, params);
    } else {
        const SampledPicture& to = *list.samples;
        params.clipFromWorld = to.clipFromWorld;
        params.size = {to.size.width, to.size.height};
        params.firstRow = to.firstRow;
        params.rows = to.rows;
        params.capacity = list.projectedClusters;
        rec.dispatchIndirect(
            project, list.counts, at(clusters, kWords),
            scene::withScene(scene, {scene.meshletVertices, list.counts, list.projected.buffer(),
                                     list.projectedDepths.buffer()}),
            params);
        rec.barrier(Stage::compute, Stage::compute);
        rec.barrier(Stage::compute, Stage::indirect);
        rec.dispatchIndirect(cullProjected, list.counts, at(clusters, kWords), bindings, params);
        rec.dispatchIndirect(
            cullTriangles, list.counts,
            offsetof(shared::CullCounts, beyond) + number * sizeof(shared::CullBeyond), bindings,
            params);
    }
    scan(rec, list.triangleOffsets, list,
         {.source = clusters,
          .result = triangles,
          .times = 1,
          .capacity = list.trianglePlaces,
          .before = second ? shared::LS_LIST_TRIANGLES : triangles,
          .totals = list.clusterPlaces});
    rec.dispatchIndirect(emit, list.counts, at(clusters, kWords),
                         {scene.clusters, list.counts, list.masks, list.triangleOffsets,
                          list.ids.buffer(), list.draws},
                         shared::EmitParams{phase, list.clusterPlaces, params.capacity});
}

}  // namespace lodestar::geometry

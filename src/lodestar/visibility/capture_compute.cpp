// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/capture_compute.hpp>

#include <cstddef>

#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/visibility/capture_ss.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kArgsCode[] =
#include <lodestar/visibility/capture_args.comp.inc>
    ;
constexpr std::uint32_t kIdsCode[] =
#include <lodestar/visibility/capture_ids.comp.inc>
    ;
constexpr std::uint32_t kSmallCode[] =
#include <lodestar/visibility/capture_small.comp.inc>
    ;
constexpr std::uint32_t kClipCode[] =
#include <lodestar/visibility/capture_clip.comp.inc>
    ;
constexpr std::uint32_t kSplitCode[] =
#include <lodestar/visibility/capture_split.comp.inc>
    ;
constexpr std::uint32_t kTileCode[] =
#include <lodestar/visibility/capture_tile.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

constexpr std::uint32_t kSmallSamples = 256;

/// Tiles of a band, whatever its shape.
std::uint64_t tilesOf(std::uint64_t samples) {
    constexpr std::uint64_t kSide = 16384;
    return samples / (shared::LS_CAPTURE_TILE_WIDTH * shared::LS_CAPTURE_TILE_HEIGHT) +
           2 * kSide / shared::LS_CAPTURE_TILE_WIDTH + kSide / shared::LS_CAPTURE_TILE_HEIGHT + 2;
}

const gpu::Device& checked(const gpu::Device& device) {
    if (!device.hasInt64Atomics())
        throw gpu::DeviceError(device.description().name +
                               " has no 64-bit atomics: capture by supersampling instead");
    return device;
}

}  // namespace

CaptureCompute::Queue CaptureCompute::makeQueue(const gpu::Device& device,
                                                const scene::SceneFeatures& f, bool masked) {
    const auto kernel = [&](const char* name, std::span<const std::uint32_t> code,
                            bool projected = true) {
        std::vector<gpu::SlotArray> slots{Slot::texelBuffer,
                                          {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS}};
        slots.insert(slots.end(), 6, Slot::texelBuffer);
        slots.insert(slots.end(), 7, Slot::storageBuffer);
        slots.emplace_back(Slot::texelBuffer);
        return gpu::Kernel(device, std::string("capture: ") + name + (masked ? ", masked" : ""),
                           code, scene::withSceneSlots(slots), sizeof(shared::CaptureComputeParams),
                           {f.uvTransforms, masked, f.baseColorArrays, kSmallSamples, projected});
    };
    return {kernel("small triangles", kSmallCode),
            kernel("unprojected triangles", kSmallCode, false), kernel("clip", kClipCode),
            kernel("split", kSplitCode), kernel("tiles", kTileCode)};
}

CaptureCompute::CaptureCompute(const gpu::Device& device, const scene::SceneFeatures& features)
    : sampler(makeTextureSampler(checked(device))),
      args(device, "capture: args", kArgsCode, std::vector<gpu::SlotArray>(4, Slot::storageBuffer),
           sizeof(shared::CaptureArgsParams)),
      ids(device, "capture: ids", kIdsCode, {Slot::texelBuffer, Slot::storageImage},
          sizeof(glm::uvec2)),
      opaque(makeQueue(device, features, false)),
      masked(makeQueue(device, features, true)) {}

std::uint64_t CaptureCompute::Scratch::fixedBytes() {
    return 48ull * shared::LS_CAPTURE_LARGE + 8ull * shared::LS_CAPTURE_JOBS +
           4ull * shared::LS_CAPTURE_CLIPPED + 2 * sizeof(shared::CaptureQueueCounts) +
           8 * tilesOf(0);
}

CaptureCompute::Scratch::Scratch(const gpu::Device& device, std::uint64_t samples)
    : words(device, "capture: samples", 16 * ((samples + 1) / 2), vk::Format::eR32G32Uint),
      pairs(device, words, vk::Format::eR32G32B32A32Uint),
      large(device, "capture: large triangles", 48ull * shared::LS_CAPTURE_LARGE,
            vk::Format::eR32G32B32A32Uint),
      jobs(device, "capture: triangles in tiles", 8ull * shared::LS_CAPTURE_JOBS,
           vk::Format::eR32G32Uint),
      opaqueCounts(device, "capture: counts", sizeof(shared::CaptureQueueCounts)),
      maskedCounts(device, "capture: counts", sizeof(shared::CaptureQueueCounts)),
      heads(device, "capture: tiles", 4 * tilesOf(samples)),
      touched(device, "capture: touched tiles", 4 * tilesOf(samples)),
      clipped(device, "capture: triangles to clip", 4ull * shared::LS_CAPTURE_CLIPPED) {}

bool CaptureCompute::fits(const gpu::Device& device, vk::Extent2D samples) {
    const auto& limits = device.physical().getProperties().limits;
    const std::uint64_t count = std::uint64_t{samples.width} * samples.height;
    return device.hasInt64Atomics() && 8 * count <= limits.maxStorageBufferRange &&
           count <= limits.maxTexelBufferElements;
}

void CaptureCompute::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                            const geometry::DrawList& list, const geometry::SampledPicture& picture,
                            const Scratch& scratch, const std::string& name,
                            geometry::DrawPhase phase) const {
    using geometry::DrawPhase;
    const vk::Extent2D size = picture.size;
    if (size.width == 0 || picture.rows == 0 || size.width > 16384 || size.height > 16384 ||
        picture.firstRow + picture.rows > size.height)
        throw std::invalid_argument("CaptureCompute::record: picture");
    if (scratch.words.buffer().bytes() < 8ull * size.width * picture.rows)
        throw std::invalid_argument("CaptureCompute::record: scratch is for smaller bands");
    const auto pass = rec.pass(name);
    const bool projected = list.samples && list.samples->size == size &&
                           list.samples->clipFromWorld == picture.clipFromWorld;
    const shared::CaptureComputeParams params{.clipFromWorld = picture.clipFromWorld,
                                              .size = {size.width, size.height},
                                              .firstRow = picture.firstRow,
                                              .rows = picture.rows,
                                              .table = list.table,
                                              .textureScale = picture.textureScale};
    if (phase != DrawPhase::second) {
        rec.fill(scratch.words.buffer(), 0);
        recordPhase(rec, scene, list, params, scratch, 0, projected);
    }
    if (phase != DrawPhase::first) recordPhase(rec, scene, list, params, scratch, 1, projected);
    rec.barrier(Stage::transfer, Stage::compute);  // a scene of nothing has no more
}

void CaptureCompute::recordPhase(gpu::Recorder& rec, const scene::GpuScene& scene,
                                 const geometry::DrawList& list,
                                 const shared::CaptureComputeParams& params, const Scratch& scratch,
                                 std::uint32_t phase, bool projected) const {
    const auto firstDraw = static_cast<std::uint32_t>(phase * scene::kDrawBins);
    rec.barrier(Stage::indirect, Stage::compute);  // the phase before
    rec.dispatch(args, {1, 1, 1},
                 {list.draws, scratch.opaqueCounts, scratch.maskedCounts, list.counts},
                 shared::CaptureArgsParams{firstDraw, projected});
    rec.barrier(Stage::compute, Stage::indirect);
    const auto& bins = scene.binStarts();
    if (bins[0] != bins[2])
        recordQueue(rec, scene, list, params, scratch, opaque, scratch.opaqueCounts);
    if (bins[2] != bins[4])
        recordQueue(rec, scene, list, params, scratch, masked, scratch.maskedCounts);
}

void CaptureCompute::recordQueue(gpu::Recorder& rec, const scene::GpuScene& scene,
                                 const geometry::DrawList& list,
                                 const shared::CaptureComputeParams& params, const Scratch& scratch,
                                 const Queue& queue, const gpu::Buffer& counts) const {
    using Counts = shared::CaptureQueueCounts;
    const auto bindings = scene::withScene(scene, {scene.materials,
                                                   {scene.textureViews(), sampler},
                                                   scene.secondUvs,
                                                   list.ids,
                                                   list.projected,
                                                   scratch.words,
                                                   scratch.large,
                                                   scratch.jobs,
                                                   scratch.words.buffer(),
                                                   counts,
                                                   scratch.large.buffer(),
                                                   scratch.jobs.buffer(),
                                                   scratch.heads,
                                                   scratch.touched,
                                                   scratch.clipped,
                                                   list.projectedDepths});
    rec.barrier(Stage::compute, Stage::transfer);
    rec.fill(scratch.heads, 0);
    rec.barrier(Stage::transfer, Stage::compute);
    rec.barrier(Stage::compute, Stage::compute);
    rec.dispatchIndirect(queue.small, counts, offsetof(Counts, groups), bindings, params);
    rec.dispatchIndirect(queue.slow, counts, offsetof(Counts, slowGroups), bindings, params);
    for (const auto& [kernel, groups] : {std::pair{&queue.clip, offsetof(Counts, clipGroups)},
                                         {&queue.split, offsetof(Counts, splitGroups)},
                                         {&queue.tile, offsetof(Counts, tileGroups)}}) {
        rec.barrier(Stage::compute, Stage::compute);
        rec.barrier(Stage::compute, Stage::indirect);
        rec.dispatchIndirect(*kernel, counts, groups, bindings, params);
    }
    rec.barrier(Stage::compute, Stage::compute);
}

void CaptureCompute::recordIds(gpu::Recorder& rec, const Scratch& scratch, gpu::View view) const {
    const auto pass = rec.pass("ids");
    rec.dispatch(ids, gpu::groups8x8(view.extent), {scratch.words, view},
                 glm::uvec2(view.extent.width, view.extent.height));
}

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/capture_compute.hpp>

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

const gpu::Device& checked(const gpu::Device& device) {
    if (!device.hasInt64Atomics())
        throw gpu::DeviceError(device.description().name +
                               " has no 64-bit atomics: capture by supersampling instead");
    return device;
}

}  // namespace

CaptureCompute::Queue CaptureCompute::makeQueue(const gpu::Device& device,
                                                const scene::SceneFeatures& f, bool masked) {
    const auto kernel = [&](const char* name, std::span<const std::uint32_t> code) {
        return gpu::Kernel(device, std::string("capture: ") + name + (masked ? ", masked" : ""),
                           code,
                           scene::withSceneSlots({Slot::storageBuffer,
                                                  Slot::storageBuffer,
                                                  Slot::storageBuffer,
                                                  Slot::storageBuffer,
                                                  Slot::texelBuffer,
                                                  {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                                  Slot::texelBuffer,
                                                  Slot::storageBuffer,
                                                  Slot::texelBuffer}),
                           sizeof(shared::CaptureComputeParams),
                           {f.uvTransforms, masked, f.baseColorArrays, kSmallSamples});
    };
    return {kernel("small triangles", kSmallCode), kernel("clip", kClipCode),
            kernel("split", kSplitCode), kernel("tiles", kTileCode)};
}

CaptureCompute::CaptureCompute(const gpu::Device& device, const scene::SceneFeatures& features)
    : sampler(makeTextureSampler(checked(device))),
      args(device, "capture: args", kArgsCode,
           {Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer}, sizeof(std::uint32_t)),
      ids(device, "capture: ids", kIdsCode, {Slot::texelBuffer, Slot::storageImage},
          sizeof(glm::uvec2)),
      opaque(makeQueue(device, features, false)),
      masked(makeQueue(device, features, true)) {}

std::uint64_t CaptureCompute::Scratch::fixedBytes(const scene::GpuScene&) {
    return sizeof(shared::CaptureLarge) * std::uint64_t{shared::LS_CAPTURE_LARGE} +
           8ull * shared::LS_CAPTURE_JOBS + 4ull * shared::LS_CAPTURE_CLIPPED +
           2 * sizeof(shared::CaptureQueueCounts);
}

CaptureCompute::Scratch::Scratch(const gpu::Device& device, const scene::GpuScene&,
                                 std::uint64_t samples)
    : words(device, "capture: samples", 8 * samples, vk::Format::eR32G32Uint),
      opaqueCounts(device, "capture: counts", sizeof(shared::CaptureQueueCounts)),
      maskedCounts(device, "capture: counts", sizeof(shared::CaptureQueueCounts)),
      large(device, "capture: large triangles",
            sizeof(shared::CaptureLarge) * std::uint64_t{shared::LS_CAPTURE_LARGE}),
      jobs(device, "capture: tiles", 8ull * shared::LS_CAPTURE_JOBS),
      clipped(device, "capture: triangles to clip", 4ull * shared::LS_CAPTURE_CLIPPED) {}

bool CaptureCompute::fits(const gpu::Device& device, vk::Extent2D samples) {
    const auto& limits = device.physical().getProperties().limits;
    const std::uint64_t count = std::uint64_t{samples.width} * samples.height;
    return device.hasInt64Atomics() && 8 * count <= limits.maxStorageBufferRange &&
           count <= limits.maxTexelBufferElements;
}

void CaptureCompute::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                            const geometry::DrawList& list, const glm::mat4& clipFromWorld,
                            const Grid& grid, const Scratch& scratch,
                            geometry::DrawPhase phase) const {
    using geometry::DrawPhase;
    const std::uint32_t rows = grid.rows == 0 ? grid.gridC.height : grid.rows;
    if (grid.gridC.width == 0 || rows == 0 || grid.gridC.width > 16384 ||
        grid.gridC.height > 16384 || grid.firstRow + rows > grid.gridC.height)
        throw std::invalid_argument("CaptureCompute::record: gridC");
    if (scratch.words.buffer().bytes() < 8ull * grid.gridC.width * rows)
        throw std::invalid_argument("CaptureCompute::record: scratch is for smaller bands");
    const auto pass = rec.pass(grid.name);
    const shared::CaptureComputeParams params{.clipFromWorld = clipFromWorld,
                                              .size = {grid.gridC.width, grid.gridC.height},
                                              .firstRow = grid.firstRow,
                                              .rows = rows};
    if (phase != DrawPhase::second) {
        rec.fill(scratch.words.buffer(), 0);
        rec.barrier(Stage::transfer, Stage::compute);
        recordPhase(rec, scene, list, params, scratch, 0);
    }
    if (phase != DrawPhase::first) recordPhase(rec, scene, list, params, scratch, 1);
}

void CaptureCompute::recordPhase(gpu::Recorder& rec, const scene::GpuScene& scene,
                                 const geometry::DrawList& list,
                                 const shared::CaptureComputeParams& params, const Scratch& scratch,
                                 std::uint32_t phase) const {
    const auto firstDraw = static_cast<std::uint32_t>(phase * scene::kDrawBins);
    rec.dispatch(args, {1, 1, 1}, {list.draws, scratch.opaqueCounts, scratch.maskedCounts},
                 firstDraw);
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::indirect);
    const auto run = [&](const Queue& queue, const gpu::Buffer& counts) {
        const auto bindings = scene::withScene(scene, {scratch.words.buffer(),
                                                       counts,
                                                       scratch.large,
                                                       scratch.jobs,
                                                       scene.materials,
                                                       {scene.textureViews(), sampler},
                                                       scene.secondUvs,
                                                       scratch.clipped,
                                                       list.ids});
        constexpr vk::Extent3D kShared{shared::LS_CAPTURE_LOOPS, 1, 1};
        rec.dispatchIndirect(queue.small, counts, bindings, params);
        for (const gpu::Kernel* next : {&queue.clip, &queue.split, &queue.tile}) {
            rec.barrier(Stage::compute, Stage::compute);
            rec.dispatch(*next, kShared, bindings, params);
        }
        rec.barrier(Stage::compute, Stage::compute);
    };
    const auto& bins = scene.binStarts();
    if (bins[0] != bins[2]) run(opaque, scratch.opaqueCounts);
    if (bins[2] != bins[4]) run(masked, scratch.maskedCounts);
    rec.barrier(Stage::indirect, Stage::compute);  // the next phase counts anew
}

void CaptureCompute::recordIds(gpu::Recorder& rec, const Scratch& scratch, gpu::View view) const {
    const auto pass = rec.pass("ids");
    rec.dispatch(ids, gpu::groups8x8(view.extent), {scratch.words, view},
                 glm::uvec2(view.extent.width, view.extent.height));
}

}  // namespace lodestar::visibility

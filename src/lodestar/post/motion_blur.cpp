// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/motion_blur_params.h>
#include <lodestar/post/effective.hpp>
#include <lodestar/post/motion_blur.hpp>

namespace lodestar::post {
namespace {

constexpr std::uint32_t kPack[] =
#include <lodestar/post/motion_blur_pack.comp.inc>
    ;
constexpr std::uint32_t kTiles[] =
#include <lodestar/post/motion_blur_tiles.comp.inc>
    ;
constexpr std::uint32_t kGather[] =
#include <lodestar/post/motion_blur.comp.inc>
    ;
constexpr std::uint32_t kCombine[] =
#include <lodestar/post/motion_blur_combine.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

vk::Extent2D tilesOf(vk::Extent2D size) {
    return {gpu::groups(size.width, shared::LS_MOTION_TILE),
            gpu::groups(size.height, shared::LS_MOTION_TILE)};
}

gpu::Image image(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                 const char* name) {
    using Usage = vk::ImageUsageFlagBits;
    return {device,
            {.name = name,
             .format = format,
             .extent = extent,
             .usage = Usage::eSampled | Usage::eStorage}};
}

gpu::Kernel makeKernel(const gpu::Device& device, const char* name,
                       std::span<const std::uint32_t> code, std::uint32_t sampled,
                       std::uint32_t constant = 0) {
    std::vector<gpu::SlotArray> slots(sampled, Slot::sampledImage);
    slots.emplace_back(Slot::storageImage);
    return {device, name, code, slots, sizeof(shared::MotionBlurParams), {constant}};
}

}  // namespace

MotionBlur::MotionBlur(const gpu::Device& device, vk::Extent2D room)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      pack(makeKernel(device, "motion blur: pack", kPack, 3)),
      tileMax(makeKernel(device, "motion blur: tiles", kTiles, 2)),
      tilesAround(makeKernel(device, "motion blur: tiles around", kTiles, 2, 1)),
      gather(makeKernel(device, "motion blur: gather", kGather, 2)),
      combine{makeKernel(device, "motion blur: combine", kCombine, 3, 0),
              makeKernel(device, "motion blur: combine, bilateral", kCombine, 3, 1)},
      moving(image(device, room, vk::Format::eR32G32B32A32Uint, "motion blur: inputs")),
      tiles(image(device, tilesOf(room), vk::Format::eR32G32Sfloat, "motion blur: tiles")),
      around(image(device, tilesOf(room), vk::Format::eR32G32Sfloat, "motion blur: around")),
      blur(image(device, room, vk::Format::eR16G16B16A16Sfloat, "motion blur")) {}

void MotionBlur::record(gpu::Recorder& rec, const Inputs& in, float shutter,
                        gpu::View color) const {
    require(shutter >= 0 && shutter <= 1, "MotionBlur: the shutter must be 0 … 1");
    const vk::Extent2D size{in.grid.size.x, in.grid.size.y}, tileCount = tilesOf(size);
    const shared::MotionBlurParams params{.grid = in.grid,
                                          .tiles = {tileCount.width, tileCount.height},
                                          .shutter = shutter,
                                          .longest = 2.0f * shared::LS_MOTION_TILE};
    const auto sampled = [&](const gpu::View& view) { return gpu::Binding(view, pointSampler); };
    {
        const auto pass = rec.pass("motion blur");
        rec.dispatch(pack, gpu::groups8x8(size),
                     {sampled(color), sampled(in.depth), sampled(in.motion), moving}, params);
        rec.barrier(Stage::compute, Stage::compute);
        rec.dispatch(tileMax, gpu::groups8x8(tileCount), {sampled(moving), sampled(around), tiles},
                     params);
        rec.barrier(Stage::compute, Stage::compute);
        rec.dispatch(tilesAround, gpu::groups8x8(tileCount),
                     {sampled(moving), sampled(tiles), around}, params);
        rec.barrier(Stage::compute, Stage::compute);
        rec.dispatch(gather, gpu::groups8x8(size), {sampled(moving), sampled(around), blur},
                     params);
        rec.barrier(Stage::compute, Stage::compute);
    }
    const auto pass = rec.pass("motion blur combine");
    rec.dispatch(combine[in.bilateral], gpu::groups8x8({in.grid.fullSize.x, in.grid.fullSize.y}),
                 {sampled(in.depth), sampled(moving), sampled(blur), color}, params);
}

}  // namespace lodestar::post

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/max_depth_params.h>
#include <lodestar/post/effective.hpp>
#include <lodestar/post/max_depth.hpp>

namespace lodestar::post {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/post/max_depth.comp.inc>
    ;

using gpu::Slot;
using Usage = vk::ImageUsageFlagBits;

vk::Extent2D half(vk::Extent2D size) {
    return {(size.width + 1) / 2, (size.height + 1) / 2};
}

}  // namespace

MaxDepth::MaxDepth(const gpu::Device& device, vk::Extent2D room)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "max depth", kCode,
             {Slot::sampledImage, Slot::sampledImage, Slot::storageImage, Slot::storageImage},
             sizeof(shared::MaxDepthParams)) {
    for (int i = 0; i < 2; ++i) {
        room = half(room);
        const auto usage = Usage::eSampled | Usage::eStorage;
        depths.emplace_back(device, gpu::ImageInfo{.name = "max depth",
                                                   .format = vk::Format::eR32Sfloat,
                                                   .extent = room,
                                                   .usage = usage});
        normals.emplace_back(device, gpu::ImageInfo{.name = "max depth: normal",
                                                    .format = vk::Format::eR32Uint,
                                                    .extent = room,
                                                    .usage = usage});
    }
}

void MaxDepth::record(gpu::Recorder& rec, const Guides& full, std::uint32_t times,
                      const Guides& out) const {
    require(times >= 1 && times <= 3, "MaxDepth: 1 … 3 times");
    const auto pass = rec.pass("max depth");
    Guides from = full;
    vk::Extent2D size = full.depth.extent;
    for (std::uint32_t i = 0; i < times; ++i) {
        const Guides to = i + 1 == times ? out : Guides{depths[i], normals[i]};
        if (i > 0) rec.barrier(gpu::Stage::compute, gpu::Stage::compute);
        rec.dispatch(kernel, gpu::groups8x8(half(size)),
                     {{from.depth, pointSampler}, {from.normal, pointSampler}, to.depth, to.normal},
                     shared::MaxDepthParams{{size.width, size.height}});
        from = to;
        size = half(size);
    }
}

}  // namespace lodestar::post

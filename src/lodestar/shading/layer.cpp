// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/layer.hpp>

#include <lodestar/visibility/peel_params.h>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kListCode[] =
#include <lodestar/shading/layer_list.comp.inc>
    ;
constexpr std::uint32_t kResolveCode[] =
#include <lodestar/shading/layer_resolve.comp.inc>
    ;
constexpr std::uint32_t kBlendCode[] =
#include <lodestar/shading/layer_blend.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using shared::LS_PEELS;

gpu::Image image(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                 const char* name) {
    using Usage = vk::ImageUsageFlagBits;
    return {
        device,
        {.name = name,
         .format = format,
         .extent = extent,
         .usage = Usage::eStorage | Usage::eSampled | Usage::eTransferSrc | Usage::eTransferDst}};
}

vk::Extent2D rows(std::uint32_t fragments) {
    return {shared::LS_LAYER_ROW, std::max(gpu::groups(fragments, shared::LS_LAYER_ROW), 1u)};
}

shared::LayerParams paramsOf(const Layer::Peeled& in, std::uint32_t capacity = 0) {
    return {.size = {in.size.width, in.size.height},
            .fullSize = {in.opaqueDepth.extent.width, in.opaqueDepth.extent.height},
            .capacity = capacity};
}

}  // namespace

Layer::Fragments::Fragments(const gpu::Device& device, std::uint32_t room)
    : capacity(room),
      ids(image(device, rows(room), vk::Format::eR32Uint, "layer: fragment ids")),
      points(image(device, rows(room), vk::Format::eR32G32Sfloat, "layer: fragment points")),
      count(device, "layer: fragment count", sizeof(std::uint32_t), gpu::Residence::mapped) {}

vk::Extent2D Layer::Fragments::extent() const {
    return rows(std::min(found(), capacity));
}

Layer::Targets::Targets(const gpu::Device& device, vk::Extent2D room)
    : slots(image(device, room, vk::Format::eR32G32B32A32Uint, "layer: slots")),
      guide(image(device, room, vk::Format::eR32Sfloat, "layer: guide")),
      color(image(device, room, vk::Format::eR16G16B16A16Sfloat, "layer: color")),
      curve(image(device, room, vk::Format::eR32Sfloat, "layer: curve")) {}

Layer::Layer(const gpu::Device& device)
    : sampler(device.vk(), vk::SamplerCreateInfo{}),
      list(device, "layer: list", kListCode,
           {{Slot::sampledImage, LS_PEELS},
            {Slot::sampledImage, LS_PEELS},
            Slot::sampledImage,
            Slot::storageBuffer,
            Slot::storageImage,
            Slot::storageImage,
            Slot::storageImage,
            Slot::storageImage},
           sizeof(shared::LayerParams)),
      resolve(device, "layer: resolve", kResolveCode,
              {{Slot::sampledImage, LS_PEELS},
               Slot::sampledImage,
               Slot::sampledImage,
               Slot::storageImage,
               Slot::storageImage},
              sizeof(shared::LayerParams)),
      blend(device, "layer: blend", kBlendCode,
            {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::sampledImage,
             Slot::storageImage, Slot::storageImage},
            sizeof(shared::LayerParams)) {}

void Layer::recordList(gpu::Recorder& rec, const Peeled& in, const Fragments& fragments,
                       const Targets& to) const {
    const auto pass = rec.pass("layer: list");
    rec.fill(fragments.count, 0);
    // What the last row holds beyond the fragments is shaded too: nothing must be there.
    rec.vk().clearColorImage(
        fragments.ids.view().image, vk::ImageLayout::eGeneral,
        vk::ClearColorValue(std::array<std::uint32_t, 4>{}),
        vk::ImageSubresourceRange{
            .aspectMask = vk::ImageAspectFlagBits::eColor, .levelCount = 1, .layerCount = 1});
    rec.barrier(Stage::transfer, Stage::compute);
    rec.dispatch(list, gpu::groups8x8(in.size),
                 {{in.ids, sampler},
                  {in.alphas, sampler},
                  {in.opaqueDepth, sampler},
                  fragments.count,
                  fragments.ids,
                  fragments.points,
                  to.slots,
                  to.guide},
                 paramsOf(in, fragments.capacity));
    rec.barrier(Stage::compute, Stage::host);
}

void Layer::recordBlend(gpu::Recorder& rec, const Peeled& in, gpu::View fragmentRadiance,
                        const Targets& to, gpu::View radiance, gpu::View coverage) const {
    const auto pass = rec.pass("layer: blend");
    rec.dispatch(resolve, gpu::groups8x8(in.size),
                 {{in.alphas, sampler},
                  {to.slots, sampler},
                  {fragmentRadiance, sampler},
                  to.color,
                  to.curve},
                 paramsOf(in));
    rec.barrier(Stage::compute, Stage::compute);
    rec.dispatch(blend, gpu::groups8x8(radiance.extent),
                 {{in.opaqueDepth, sampler},
                  {to.guide, sampler},
                  {to.color, sampler},
                  {to.curve, sampler},
                  radiance,
                  coverage},
                 paramsOf(in));
}

}  // namespace lodestar::shading

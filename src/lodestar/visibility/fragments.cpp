// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/fragments.hpp>

#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kFragmentsCode[] =
#include <lodestar/visibility/fragments.comp.inc>
    ;
constexpr std::uint32_t kMergeCode[] =
#include <lodestar/visibility/merge.comp.inc>
    ;
constexpr std::uint32_t kResolveCode[] =
#include <lodestar/visibility/resolve.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

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

vk::Extent2D moreRows(std::uint32_t fragments) {
    return {shared::LS_FRAGMENT_ROW, std::max(gpu::groups(fragments, shared::LS_FRAGMENT_ROW), 1u)};
}

shared::FragmentsParams paramsOf(const FragmentSet& set) {
    return {.base = {set.base.width, set.base.height}, .capacity = set.capacity};
}

}  // namespace

FragmentSet::FragmentSet(const gpu::Device& device, vk::Extent2D b, std::uint32_t room)
    : capacity(room),
      base(b),
      ids(image(device, base, vk::Format::eR32Uint, "fragments: ids")),
      points(image(device, base, vk::Format::eR32G32Sfloat, "fragments: points")),
      moreIds(image(device, moreRows(room), vk::Format::eR32Uint, "fragments: more ids")),
      morePoints(
          image(device, moreRows(room), vk::Format::eR32G32Sfloat, "fragments: more points")),
      counts(device, "fragments: counts", sizeof(shared::FragmentCounts), gpu::Residence::mapped),
      mixed(device, "fragments: mixed pixels", 4ull * base.width * base.height),
      further(device, "fragments: further pixels", sizeof(shared::FurtherPixel) * room),
      weights(device, "fragments: weights", 4ull * room) {}

vk::Extent2D FragmentSet::moreExtent() const {
    return moreRows(std::min(found().further, capacity));
}

Fragments::Fragments(const gpu::Device& device, std::uint32_t s)
    : side(s),
      sampler(device.vk(), vk::SamplerCreateInfo{}),
      find(device, "fragments", kFragmentsCode,
           {Slot::texelBuffer, Slot::texelBuffer, Slot::storageImage, Slot::storageImage,
            Slot::storageBuffer, Slot::storageBuffer},
           sizeof(shared::FragmentsParams), {side}),
      merge(device, "merge", kMergeCode,
            scene::withSceneSlots({Slot::texelBuffer, Slot::texelBuffer, Slot::uniformBuffer,
                                   Slot::sampledImage, Slot::sampledImage, Slot::sampledImage,
                                   Slot::sampledImage, Slot::storageBuffer, Slot::storageBuffer,
                                   Slot::storageImage, Slot::storageImage, Slot::storageImage,
                                   Slot::storageBuffer, Slot::storageBuffer}),
            sizeof(shared::FragmentsParams), {side}),
      resolve(device, "resolve", kResolveCode,
              {Slot::sampledImage, Slot::storageBuffer, Slot::storageBuffer, Slot::storageBuffer,
               Slot::storageImage},
              sizeof(shared::FragmentsParams), {side * side}) {}

void Fragments::record(gpu::Recorder& rec, const CompactRecord& from,
                       const FragmentSet& set) const {
    if (from.side != side) throw std::invalid_argument("Fragments: record of another rate");
    if (set.base != from.base) throw std::invalid_argument("Fragments: set of another grid");
    const auto pass = rec.pass("fragments");
    rec.fill(set.counts, 0);
    // What the last row holds beyond the fragments is shaded too: nothing must be there.
    rec.vk().clearColorImage(
        set.moreIds.view().image, vk::ImageLayout::eGeneral,
        vk::ClearColorValue(std::array<std::uint32_t, 4>{}),
        vk::ImageSubresourceRange{
            .aspectMask = vk::ImageAspectFlagBits::eColor, .levelCount = 1, .layerCount = 1});
    rec.barrier(Stage::transfer, Stage::compute);
    rec.dispatch(find, gpu::groups8x8(from.base),
                 {from.heads, from.lists, set.ids, set.points, set.counts, set.mixed},
                 paramsOf(set));
}

void Fragments::recordMerge(gpu::Recorder& rec, const scene::GpuScene& scene,
                            const CompactRecord& from, const MainInputs& main,
                            const FragmentSet& set, const gpu::Image& out) const {
    const auto pass = rec.pass("merge");
    const vk::ImageSubresourceLayers layers{.aspectMask = vk::ImageAspectFlagBits::eColor,
                                            .layerCount = 1};
    rec.barrier(Stage::compute, Stage::transfer);
    rec.vk().copyImage(main.radiance.image, vk::ImageLayout::eGeneral, out.view().image,
                       vk::ImageLayout::eGeneral,
                       vk::ImageCopy{.srcSubresource = layers,
                                     .dstSubresource = layers,
                                     .extent = {set.base.width, set.base.height, 1}});
    rec.barrier(Stage::transfer, Stage::compute);
    rec.dispatch(merge, {shared::LS_MERGE_GROUPS, 1, 1},
                 scene::withScene(scene, {from.heads,
                                          from.lists,
                                          main.view,
                                          {set.ids, sampler},
                                          {main.depth, sampler},
                                          {main.normal, sampler},
                                          {main.radiance, sampler},
                                          set.counts,
                                          set.mixed,
                                          out,
                                          set.moreIds,
                                          set.morePoints,
                                          set.weights,
                                          set.further}),
                 paramsOf(set));
    rec.barrier(Stage::compute, Stage::host);
}

void Fragments::recordResolve(gpu::Recorder& rec, gpu::View radiance, const FragmentSet& set,
                              const gpu::Image& out) const {
    const auto pass = rec.pass("resolve");
    rec.dispatch(resolve, {std::max(gpu::groups(set.found().pixels, 64), 1u), 1, 1},
                 {{radiance, sampler}, set.counts, set.weights, set.further, out}, paramsOf(set));
}

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/fragments.hpp>

#include <lodestar/visibility/fragments_params.h>
#include <lodestar/scene/scene_bindings.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/visibility/fragments.comp.inc>
    ;
constexpr std::uint32_t kResolveCode[] =
#include <lodestar/visibility/resolve.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

constexpr std::uint32_t kGroup = 64;

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

gpu::Kernel makeKernel(const gpu::Device& device, std::uint32_t side, bool write) {
    return {device,
            write ? "fragments: write" : "fragments: count",
            kCode,
            scene::withSceneSlots({Slot::texelBuffer, Slot::texelBuffer, Slot::storageBuffer,
                                   Slot::storageImage, Slot::storageImage, Slot::storageImage,
                                   Slot::storageImage, Slot::storageBuffer, Slot::storageBuffer}),
            sizeof(shared::FragmentsParams),
            {side, write}};
}

}  // namespace

FragmentSet::FragmentSet(const gpu::Device& device, const CompactRecord& record, std::uint32_t room)
    : capacity(room),
      base(record.base),
      ids(image(device, base, vk::Format::eR32Uint, "fragments: ids")),
      points(image(device, base, vk::Format::eR32G32Sfloat, "fragments: points")),
      moreIds(image(device, moreRows(room), vk::Format::eR32Uint, "fragments: more ids")),
      morePoints(
          image(device, moreRows(room), vk::Format::eR32G32Sfloat, "fragments: more points")),
      offsets(device, "fragments: offsets",
              4ull * gpu::PrefixSum::bufferLength(base.width * base.height + 1)),
      weights(device, "fragments: weights", 4ull * room),
      merges(device, "fragments: merges", record.lists.buffer().bytes()),
      total(device, "fragments: total", 4, gpu::Residence::mapped) {}

vk::Extent2D FragmentSet::moreExtent() const {
    return moreRows(std::min(needed(), capacity));
}

Fragments::Fragments(const gpu::Device& device, std::uint32_t s)
    : side(s),
      count(makeKernel(device, s, false)),
      write(makeKernel(device, s, true)),
      prefixSum(device) {}

void Fragments::dispatch(gpu::Recorder& rec, const gpu::Kernel& kernel,
                         const scene::GpuScene& scene, const CompactRecord& from,
                         const glm::mat4& clipFromWorld, glm::vec3 eye, FragmentSet& set) const {
    if (from.side != side) throw std::invalid_argument("Fragments: record of another rate");
    if (set.ids.extent() != from.base)
        throw std::invalid_argument("Fragments: set of another grid");
    if (set.merges.bytes() < from.lists.buffer().bytes())
        throw std::invalid_argument("Fragments: set for a record with shorter lists");
    const std::uint32_t groupCount = gpu::groups(from.base.width * from.base.height + 1, kGroup);
    const std::uint32_t lines = gpu::groups(groupCount, 32768);
    rec.dispatch(kernel, {gpu::groups(groupCount, lines), lines, 1},
                 scene::withScene(scene, {from.heads, from.lists, set.offsets, set.ids, set.points,
                                          set.moreIds, set.morePoints, set.weights, set.merges}),
                 shared::FragmentsParams{.clipFromWorld = clipFromWorld,
                                         .eye = eye,
                                         .base = {from.base.width, from.base.height},
                                         .capacity = set.capacity});
}

void Fragments::recordCount(gpu::Recorder& rec, const scene::GpuScene& scene,
                            const CompactRecord& from, const glm::mat4& clipFromWorld,
                            glm::vec3 eye, FragmentSet& set) const {
    const auto pass = rec.pass("fragments");
    dispatch(rec, count, scene, from, clipFromWorld, eye, set);
    rec.barrier(Stage::compute, Stage::compute);
    const std::uint32_t pixels = from.base.width * from.base.height;
    prefixSum.record(rec, set.offsets, pixels + 1);
    rec.barrier(Stage::compute, Stage::transfer);
    rec.vk().copyBuffer(set.offsets.vk(), set.total.vk(),
                        vk::BufferCopy{.srcOffset = 4ull * pixels, .size = 4});
    rec.barrier(Stage::transfer, Stage::host);
}

void Fragments::recordWrite(gpu::Recorder& rec, const scene::GpuScene& scene,
                            const CompactRecord& from, const glm::mat4& clipFromWorld,
                            glm::vec3 eye, FragmentSet& set) const {
    const auto pass = rec.pass("fragments");
    // What the last row holds beyond the fragments is shaded too: nothing must be there.
    rec.vk().clearColorImage(
        set.moreIds.view().image, vk::ImageLayout::eGeneral,
        vk::ClearColorValue(std::array<std::uint32_t, 4>{}),
        vk::ImageSubresourceRange{
            .aspectMask = vk::ImageAspectFlagBits::eColor, .levelCount = 1, .layerCount = 1});
    rec.barrier(Stage::transfer, Stage::compute);
    dispatch(rec, write, scene, from, clipFromWorld, eye, set);
}

Resolve::Resolve(const gpu::Device& device, std::uint32_t side)
    : sampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "resolve", kResolveCode,
             {Slot::sampledImage, Slot::sampledImage, Slot::storageBuffer, Slot::storageBuffer,
              Slot::storageImage},
             0, {side * side}) {}

void Resolve::record(gpu::Recorder& rec, const FragmentSet& set, gpu::View main, gpu::View more,
                     gpu::View out) const {
    const auto pass = rec.pass("resolve");
    rec.dispatch(kernel, gpu::groups8x8(main.extent),
                 {{main, sampler}, {more, sampler}, set.offsets, set.weights, out});
}

}  // namespace lodestar::visibility

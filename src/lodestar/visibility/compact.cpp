// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/compact.hpp>

#include <stdexcept>

#include <lodestar/visibility/compact_params.h>
#include <lodestar/gpu/readback.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/visibility/compact.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

std::uint32_t checkedSide(std::uint32_t side) {
    if (side != 1 && side != 2 && side != 4 && side != 8)
        throw std::invalid_argument("side must be 1, 2, 4 or 8 samples");
    return side;
}

gpu::Kernel makeKernel(const gpu::Device& device, std::uint32_t side, bool fromBuffer,
                       bool writeLists) {
    return {device,
            writeLists ? "compact: lists" : "compact: heads",
            kCode,
            {Slot::sampledImage, Slot::texelBuffer, Slot::storageBuffer, Slot::storageBuffer,
             Slot::storageBuffer, Slot::storageBuffer},
            sizeof(shared::CompactVisibilityParams),
            {side, fromBuffer, writeLists}};
}

std::uint64_t pixelsOf(vk::Extent2D extent) {
    return std::uint64_t{extent.width} * extent.height;
}

}  // namespace

CompactRecord::CompactRecord(const gpu::Device& device, vk::Extent2D baseSize, std::uint32_t s,
                             std::uint32_t room, std::uint32_t bandCount)
    : base(baseSize),
      side(checkedSide(s)),
      capacity(room),
      bands(bandCount),
      heads(device, "visibility heads", 4 * pixelsOf(baseSize), vk::Format::eR32Uint),
      lists(device, "visibility lists", 4ull * room, vk::Format::eR32Uint),
      totals(device, "visibility totals", 4ull * (bandCount + 1), gpu::Residence::mapped) {
    if (room == 0) throw std::invalid_argument("CompactRecord: capacity is 0");
    std::fill_n(totals.mapped<std::uint32_t>(), bands + 1, 0);
}

Record readRecord(const gpu::Device& device, const CompactRecord& from) {
    if (from.overflowed()) throw std::logic_error("readRecord: the record overflowed");
    using Words = std::vector<std::uint32_t>;
    const auto words = [&](const gpu::TexelBuffer& buffer, std::uint64_t count) {
        return count == 0
                   ? Words()
                   : gpu::as<std::uint32_t>(gpu::readBuffer(device, buffer.buffer(), 4 * count));
    };
    return unpack({words(from.heads, pixelsOf(from.base)), words(from.lists, from.wordsNeeded())},
                  from.base.width, from.base.height, from.side);
}

CompactRecord uploadRecord(const gpu::Device& device, const Record& record) {
    const PackedRecord packed = pack(record);
    const auto count = static_cast<std::uint32_t>(packed.lists.size());
    CompactRecord out(device, {record.width, record.height}, record.side, std::max(count, 1u));
    out.heads.buffer().upload(packed.heads);
    out.lists.buffer().upload(packed.lists);
    out.totals.mapped<std::uint32_t>()[1] = count;
    return out;
}

Compact::Compact(const gpu::Device& device, std::uint32_t s)
    : side(checkedSide(s)),
      sampler(device.vk(), vk::SamplerCreateInfo{}),
      prefixSum(device),
      noImage(device, {.name = "no samples",
                       .format = vk::Format::eR32Uint,
                       .extent = {1, 1},
                       .usage = vk::ImageUsageFlagBits::eSampled}),
      noPairs(device, "no samples", 16, vk::Format::eR32G32B32A32Uint),
      kernels{{{makeKernel(device, side, false, false), makeKernel(device, side, false, true)},
               {makeKernel(device, side, true, false), makeKernel(device, side, true, true)}}} {}

Compact::Scratch::Scratch(const gpu::Device& device, std::uint32_t maxPixels)
    : pixels(maxPixels),
      counts(device, "visibility counts", 4ull * gpu::PrefixSum::bufferLength(maxPixels + 1)) {}

void Compact::record(gpu::Recorder& rec, const Samples& samples, const Band& band,
                     const Scratch& scratch, CompactRecord& out) const {
    const std::uint32_t pixels = out.base.width * band.rows;
    if (pixels == 0 || pixels > scratch.pixels || band.firstRow + band.rows > out.base.height ||
        band.index >= out.bands)
        throw std::invalid_argument("Compact::record: band");
    if (out.side != side) throw std::invalid_argument("Compact::record: out.side");
    const auto pass = rec.pass("compact");
    const shared::CompactVisibilityParams params{.width = out.base.width,
                                                 .firstRow = band.firstRow,
                                                 .rows = band.rows,
                                                 .band = band.index,
                                                 .capacity = out.capacity};
    const std::uint32_t groupCount = gpu::groups(pixels + 1, shared::LS_COMPACT_GROUP);
    const std::uint32_t lines = gpu::groups(groupCount, 32768);
    const vk::Extent3D groups{gpu::groups(groupCount, lines), lines, 1};
    const gpu::View& ids = samples.ids ? samples.ids->view() : noImage.view();
    const gpu::Binding pairs = samples.pairs ? gpu::Binding(*samples.pairs) : noPairs;
    const std::vector<gpu::Binding> bindings{
        {ids, sampler}, pairs, out.heads.buffer(), scratch.counts, out.lists.buffer(), out.totals};
    const auto& [count, write] = kernels[samples.pairs ? 1 : 0];
    rec.dispatch(count, groups, bindings, params);
    rec.barrier(Stage::compute, Stage::compute);
    prefixSum.record(rec, scratch.counts, pixels + 1);
    rec.dispatch(write, groups, bindings, params);
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::host);
}

}  // namespace lodestar::visibility

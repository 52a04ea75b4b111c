// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/prefix_sum_params.h>
#include <lodestar/gpu/prefix_sum.hpp>

namespace lodestar::gpu {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/gpu/prefix_sum.comp.inc>
    ;

using shared::PrefixSumParams;

/// The levels of a scan: the values, their block totals, the totals of those, … down to one.
std::vector<PrefixSumParams> levelsOf(std::uint32_t count) {
    std::vector<PrefixSumParams> levels;
    std::uint32_t offset = 0;
    for (std::uint32_t n = count;; n = groups(n, shared::LS_SCAN_BLOCK)) {
        levels.push_back({.count = n, .source = offset, .blockTotals = offset + n});
        offset += n;
        if (n <= shared::LS_SCAN_BLOCK) return levels;
    }
}

vk::Extent3D groupsOf(std::uint32_t count) {
    const std::uint32_t blocks = groups(count, shared::LS_SCAN_BLOCK);
    const std::uint32_t rows = groups(blocks, 32768);
    return {groups(blocks, rows), rows, 1};
}

}  // namespace

PrefixSum::PrefixSum(const Device& device)
    : scan(device, "prefix sum: scan", kCode, {Slot::storageBuffer}, sizeof(PrefixSumParams), {0}),
      addTotals(device, "prefix sum: add totals", kCode, {Slot::storageBuffer},
                sizeof(PrefixSumParams), {1}) {}

std::uint32_t PrefixSum::bufferLength(std::uint32_t count) {
    return levelsOf(count).back().blockTotals + 1;
}

void PrefixSum::record(Recorder& rec, const Buffer& values, std::uint32_t count) const {
    if (count == 0) throw std::invalid_argument("PrefixSum: count is 0");
    if (values.bytes() < 4ull * bufferLength(count))
        throw std::invalid_argument("PrefixSum: buffer shorter than bufferLength(count)");
    const auto levels = levelsOf(count);
    for (const PrefixSumParams& level : levels) {
        rec.dispatch(scan, groupsOf(level.count), {values}, level);
        rec.barrier(Stage::compute, Stage::compute);
    }
    for (std::size_t i = levels.size() - 1; i-- > 0;) {
        rec.dispatch(addTotals, groupsOf(levels[i].count), {values}, levels[i]);
        rec.barrier(Stage::compute, Stage::compute);
    }
}

}  // namespace lodestar::gpu

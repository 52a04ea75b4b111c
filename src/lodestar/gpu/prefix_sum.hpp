// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::gpu {

/// Exclusive prefix sum of 32-bit counts, in place and deterministic.
class PrefixSum {
public:
    explicit PrefixSum(const Device&);

    /// Values a buffer must hold to scan `count` of them: the block totals of each level follow the
    /// values. The grand total stands at index `bufferLength(count) − 1` after the scan.
    static std::uint32_t bufferLength(std::uint32_t count);

    /// Scans the first `count` (≥ 1) values of `values`. The caller has made them visible to
    /// compute; the sums are written by compute.
    void record(Recorder&, const Buffer& values, std::uint32_t count) const;

private:
    Kernel scan, addTotals;
};

}  // namespace lodestar::gpu

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <lodestar/gpu/prefix_sum.hpp>
#include <lodestar/visibility/record.hpp>
#include <lodestar/visibility/samples.hpp>

namespace lodestar::visibility {

/// The compact record of a frame on the device (record_params.h says what is in it).
struct CompactRecord {
    /// Room for `capacity` words of lists (≥ 1) and a frame captured in at most `bands` bands.
    CompactRecord(const gpu::Device&, vk::Extent2D base, std::uint32_t side, std::uint32_t capacity,
                  std::uint32_t bands = 1);

    vk::Extent2D base;   ///< grid B
    std::uint32_t side;  ///< s
    std::uint32_t capacity;
    std::uint32_t bands;
    gpu::TexelBuffer heads;  ///< R32_UINT, one a pixel
    gpu::TexelBuffer lists;  ///< R32_UINT
    gpu::Buffer totals;      ///< mapped: words before each band; the frame's after the last

    /// Words of lists that the frame needed, as the device said when the frame was done. More than
    /// `capacity`: those did not fit, and the frame must be captured again.
    std::uint32_t wordsNeeded() const { return totals.mapped<std::uint32_t>()[bands]; }
    bool overflowed() const { return wordsNeeded() > capacity; }
};

/// Reads a finished record back. Throws std::logic_error when it overflowed.
Record readRecord(const gpu::Device&, const CompactRecord&);
/// A record on the device with the contents of one in memory.
CompactRecord uploadRecord(const gpu::Device&, const Record&);

/// Compacts the samples of grid C into a head a pixel of grid B and a list of nodes for each pixel
/// that shows several triangles (thesis §3.2, tightened). Lists are placed by a prefix sum over
/// the pixels: neighbours stay neighbours, and the same samples give the same bytes, whatever the
/// bands.
class Compact {
public:
    Compact(const gpu::Device&, std::uint32_t side);

    /// Working memory for bands of up to `pixels` of grid B.
    struct Scratch {
        Scratch(const gpu::Device&, std::uint32_t pixels);
        std::uint32_t pixels;
        gpu::Buffer counts;
    };

    /// Adds a band to `out`; bands come in order from the top, and the last one has index
    /// out.bands − 1. The caller has made `samples` visible to compute, and makes `out` visible.
    void record(gpu::Recorder&, const Samples&, const Band&, const Scratch&,
                CompactRecord& out) const;

private:
    std::uint32_t side;
    vk::raii::Sampler sampler;
    gpu::PrefixSum prefixSum;
    gpu::Image noImage;
    gpu::TexelBuffer noPairs;
    std::array<std::array<gpu::Kernel, 2>, 2> kernels;  ///< [from a buffer][write lists]
};

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/visibility/capture_compute_params.h>
#include <lodestar/geometry/cull.hpp>
#include <lodestar/visibility/samples.hpp>

namespace lodestar::visibility {

/// Captures visibility in compute: integer edge functions over vertices snapped to 1/256 sample,
/// the top-left rule, and a 64-bit atomic maximum of depth and id. Ids are a function of the
/// snapped vertices alone: the same between runs, bands and thread counts. Small triangles take one
/// thread each; large ones are sorted into tiles; those that cross the near plane or reach far
/// beyond the picture are clipped first. Alpha-masked surfaces are tested in place.
class CaptureCompute {
public:
    /// Throws gpu::DeviceError on a device without 64-bit atomics (Device::hasInt64Atomics).
    CaptureCompute(const gpu::Device&, const scene::SceneFeatures&);

    /// Working memory for bands of grid C of up to `samples`.
    struct Scratch {
        Scratch(const gpu::Device&, std::uint64_t samples);
        gpu::TexelBuffer words;  ///< RG32_UINT: id, depth bits
        gpu::TexelView pairs;    ///< the same by two: RGBA32_UINT
        /// Bytes that do not depend on the samples.
        static std::uint64_t fixedBytes();
        gpu::TexelBuffer large, jobs;
        gpu::Buffer opaqueCounts, maskedCounts, heads, touched, clipped;
    };
    /// Whether the device can, for a band of this many samples.
    static bool fits(const gpu::Device&, vk::Extent2D samples);

    /// Fills scratch.words, a row of the band after the other; the second phase adds to what the
    /// first left there. `list` was culled for the band or more, best with CullView::samples of the
    /// same picture; the caller has made it visible to compute and indirect, and what was done with
    /// scratch to transfer. Grid C, the picture, has at most 16384 samples a side.
    void record(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList& list,
                const geometry::SampledPicture&, const Scratch&, const std::string& name,
                geometry::DrawPhase = geometry::DrawPhase::both) const;
    /// Ids alone, of a picture that was captured as one band: R32_UINT, storage. Opens its own
    /// pass.
    void recordIds(gpu::Recorder&, const Scratch&, gpu::View ids) const;

private:
    struct Queue {
        gpu::Kernel small, slow, clip, split, tile;
    };
    static Queue makeQueue(const gpu::Device&, const scene::SceneFeatures&, bool masked);

    void recordPhase(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList&,
                     const shared::CaptureComputeParams&, const Scratch&, std::uint32_t phase,
                     bool projected) const;
    void recordQueue(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList&,
                     const shared::CaptureComputeParams&, const Scratch&, const Queue&,
                     const gpu::Buffer& counts) const;

    vk::raii::Sampler sampler;
    gpu::Kernel args, ids;
    Queue opaque, masked;
};

}  // namespace lodestar::visibility

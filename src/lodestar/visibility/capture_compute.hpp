// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/geometry/cull.hpp>
#include <lodestar/visibility/samples.hpp>

namespace lodestar::visibility {

/// Captures visibility in compute: integer edge functions over vertices snapped to 1/256 sample,
/// the top-left rule, and a 64-bit atomic maximum of depth and id. Ids are a function of the
/// snapped vertices alone: the same between runs, bands and thread counts. Small triangles take one
/// thread each; large ones are cut into tiles and queued; those that cross the near plane or reach
/// far beyond the picture are clipped first. Alpha-masked surfaces are tested in place.
class CaptureCompute {
public:
    /// Throws gpu::DeviceError on a device without 64-bit atomics (Device::hasInt64Atomics).
    CaptureCompute(const gpu::Device&, const scene::SceneFeatures&);

    /// Working memory for bands of grid C of up to `samples`.
    struct Scratch {
        Scratch(const gpu::Device&, const scene::GpuScene&, std::uint64_t samples);
        gpu::TexelBuffer words;  ///< RG32_UINT: id, depth bits
        /// Bytes that do not depend on the samples.
        static std::uint64_t fixedBytes(const scene::GpuScene&);
        gpu::Buffer opaqueCounts, maskedCounts, large, jobs, clipped;
    };

    /// Fills scratch.words with s·rows rows of s·w samples. `list` was culled for the band or more;
    /// the caller has made it visible to compute and indirect. `clipFromWorld` is that of the whole
    /// picture. Grid C has at most 16384 samples a side.
    void record(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList& list,
                const glm::mat4& clipFromWorld, vk::Extent2D gridC, std::uint32_t firstRow,
                std::uint32_t rows, const Scratch&) const;

private:
    struct Queue {
        gpu::Kernel small, clip, split, tile;
    };
    static Queue makeQueue(const gpu::Device&, const scene::SceneFeatures&, bool masked);

    vk::raii::Sampler sampler;
    gpu::Kernel args;
    Queue opaque, masked;
};

}  // namespace lodestar::visibility

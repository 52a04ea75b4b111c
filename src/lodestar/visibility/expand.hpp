// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <lodestar/scene/gpu_scene.hpp>
#include <lodestar/visibility/compact.hpp>

namespace lodestar::visibility {

/// Rebuilds which triangle each pixel of a grid O of any size shows, from a compact record. Where
/// the centre of a pixel is a sample of grid C its id is the sample's; elsewhere, and so above the
/// capture rate, the nearest triangle that covers the centre, of those listed by the pixels of grid
/// B that own the samples around it. Attributes follow from the ids by Rebuild.
class Expand {
public:
    /// For records of `side` × `side` samples a pixel.
    Expand(const gpu::Device&, std::uint32_t side);

    /// Writes every pixel of `ids` (R32_UINT, storage). `clipFromWorld` is that of the capture. The
    /// caller has made the record visible to compute.
    void record(gpu::Recorder&, const scene::GpuScene&, const CompactRecord&,
                const glm::mat4& clipFromWorld, gpu::View ids) const;
    /// The representatives: `ids` has the size of grid B.
    void recordRepresentatives(gpu::Recorder&, const scene::GpuScene&, const CompactRecord&,
                               gpu::View ids) const;

private:
    enum Mode { onSamples, byEdges, representatives };
    void recordMode(gpu::Recorder&, Mode, const scene::GpuScene&, const CompactRecord&,
                    const glm::mat4& clipFromWorld, gpu::View ids) const;

    std::uint32_t side;
    std::array<gpu::Kernel, 3> kernels;
};

}  // namespace lodestar::visibility

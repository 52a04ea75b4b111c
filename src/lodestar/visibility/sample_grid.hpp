// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::visibility {

/// What a coarser grid S sees through the centres of its texels, from the ids of grid O: for
/// shading as a whole on S (Yang et al. 2008, §2.1) without drawing the scene again.
class SampleGrid {
public:
    explicit SampleGrid(const gpu::Device&);

    struct Outputs {
        gpu::View ids;     ///< R32_UINT, storage: the triangle of the O pixel under the centre
        gpu::View points;  ///< RG32_SFLOAT, storage: the centre, NDC
    };
    /// `rate` is r ≥ 1: O pixels a texel of S along an axis. Writes the texels in the extent of
    /// `out.ids`. Pass "sample grid".
    void record(gpu::Recorder&, gpu::View ids, float rate, const Outputs& out) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::visibility

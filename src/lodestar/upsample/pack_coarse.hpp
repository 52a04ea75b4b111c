// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/upsample/reconstruct.hpp>

namespace lodestar::upsample {

/// Packs what was shaded on grid S, so that Upsample's taps are one load each.
class PackCoarse {
public:
    explicit PackCoarse(const gpu::Device&, Packing = Packing::full);

    struct Inputs {
        gpu::View terms;   ///< grid S, any float format: the four values to reconstruct
        gpu::View depth;   ///< grid S, R32_SFLOAT: linear view depth [scene units], 0 = background
        gpu::View normal;  ///< grid S, R32_UINT: view-space normal, packNormal of octahedral.h
    };
    /// Writes the part of `coarse` (RGBA32_UINT) that `inputs.terms` covers. Pass "pack".
    void record(gpu::Recorder&, const Inputs&, gpu::View coarse) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::upsample

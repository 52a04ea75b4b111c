// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/upsample/reconstruct.hpp>

namespace lodestar::upsample {

/// Joint bilateral upsampling of a coarse shading buffer (Yang et al. 2008, eq. 1).
class Upsample {
public:
    Upsample(const gpu::Device&, Reconstruct);

    struct Inputs {
        gpu::View coarse;   ///< grid S, RGBA32_UINT: packCoarse of coarse_texel.glsl
        gpu::View depth;    ///< grid O, R32_SFLOAT: linear view depth [scene units], 0 = background
        gpu::View normal;   ///< grid O, R32_UINT: view-space normal, packNormal
        vk::Extent2D size;  ///< of S: the part of `coarse` in use
        float rate = 1;     ///< r ≥ 1: O pixels per S texel along an axis, fractional
    };
    /// Writes every texel of `terms` (grid O, RGBA16_SFLOAT). Images in GENERAL; the caller has
    /// made the inputs visible. Throws std::invalid_argument for a rate below 1, a sigma ≤ 0 or a
    /// size that is 0 or larger than `coarse`.
    void record(gpu::Recorder&, const Inputs&, const Sigmas&, gpu::View terms) const;

    Reconstruct kind() const { return reconstruct; }

private:
    Reconstruct reconstruct;
    vk::raii::Sampler pointSampler;
    gpu::Kernel guided, plain;  ///< with the range weights, and without (σn = σz = ∞)
};

}  // namespace lodestar::upsample

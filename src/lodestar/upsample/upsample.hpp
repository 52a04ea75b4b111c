// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/upsample/reconstruct.hpp>
#include <lodestar/upsample/repair.hpp>

namespace lodestar::upsample {

/// Beside the equation itself.
struct UpsampleOptions {
    std::uint32_t channels = 15;  ///< to write, a bit each; the others keep what they hold
    /// Lists, for RepairSelect, the pixels whose best tap has a range weight g·g under
    /// `leastWeight`, and those whose taps lie further apart than `mostSpread` in some term.
    const RepairList* repair = nullptr;
    float leastWeight = 0.1f;  ///< 0 … 1, both excluded
    float mostSpread = 0.1f;
};

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
        const gpu::TileList* tiles = nullptr;  ///< of O, the others being left alone; none: all
    };
    /// Writes every texel of `terms` (grid O, RGBA16_SFLOAT) that `tiles` has. Images in GENERAL;
    /// the caller has made the inputs visible. Throws std::invalid_argument for a rate below 1, a
    /// sigma ≤ 0 or a size that is 0 or larger than `coarse`.
    void record(gpu::Recorder&, const Inputs&, const Sigmas&, gpu::View terms,
                const UpsampleOptions& = {}) const;

    Reconstruct kind() const { return reconstruct; }
    /// Whether depth and normal of O are looked at.
    bool guided() const;

private:
    Reconstruct reconstruct;
    vk::raii::Sampler pointSampler;
    /// With the range weights, and without (σn = σz = ∞); then with merging, with a list.
    gpu::Kernel guidedKernel, plain, guidedMerge, plainMerge, guidedRepair, guidedMergeRepair;
    gpu::Buffer noList;  ///< what is bound where no pixels are listed
};

}  // namespace lodestar::upsample

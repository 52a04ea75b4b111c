// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/gpu/texel_list.hpp>
#include <lodestar/upsample/reconstruct.hpp>

namespace lodestar::upsample {

/// Local rates (Yang et al. 2008 name multi-resolution resizing as future work): of grid S every
/// second texel of every second row was evaluated, which is a grid of 2r. Where the terms vary
/// among these the texels between are listed, to be evaluated too; where they do not, filled in.
class Refine {
public:
    explicit Refine(const gpu::Device&);

    struct Inputs {
        gpu::View depth, normal;  ///< grid O, as of Upsample::Inputs
        vk::Extent2D size;        ///< of S: the part of `coarse` in use
        float rate = 1;           ///< r
    };
    /// Fills in `coarse` (RGBA32_UINT) or lists. A texel is filled in where the evaluated ones
    /// about it that are like it in depth and normal lie at most `spread` apart in all terms and
    /// those it would be made of are all like it. Pass "refine". Leaves the list visible to compute
    /// and indirect. Throws std::invalid_argument for a grid larger than the list's, a rate below 1
    /// or a spread that is not above 0.
    void record(gpu::Recorder&, const Inputs&, const Sigmas&, float spread, gpu::View coarse,
                const gpu::TexelList&) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::upsample

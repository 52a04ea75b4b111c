// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <lodestar/post/effective_params.h>
#include <lodestar/gpu/recorder.hpp>

namespace lodestar::post {

/// Motion blur gathered on grid B along the fastest motion around each texel (McGuire et al. 2012,
/// "A Reconstruction Filter for Plausible Motion Blur"). Streaks are at most four tiles of eight
/// texels of B long.
class MotionBlur {
public:
    /// `room` is the size of the largest grid B.
    MotionBlur(const gpu::Device&, vk::Extent2D room);

    struct Inputs {
        gpu::View depth;   ///< grid O, R32_SFLOAT: linear view depth, 0 = background
        gpu::View motion;  ///< grid O, RGBA32_SFLOAT: visibility::Motion
        shared::EffectiveGrid grid;
        bool bilateral = true;
    };
    /// Blurs `color` (grid O, RGBA16_SFLOAT, storage and sampled) in place; its alpha stays.
    /// `shutter` is the share of the time between frames that it is open. Nothing outside the grids
    /// is read. Passes "motion blur" and "motion blur combine". Throws std::invalid_argument for a
    /// shutter outside 0 … 1.
    void record(gpu::Recorder&, const Inputs&, float shutter, gpu::View color) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel pack, tileMax, tilesAround, gather;
    std::array<gpu::Kernel, 2> combine;  // linear, bilateral
    gpu::Image moving, tiles, around, blur;
};

}  // namespace lodestar::post

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::post {

/// What the thesis compares with: grid B by halving full-resolution depth, the farthest of 2 × 2
/// texels each time, with the normal that goes with it.
class MaxDepth {
public:
    /// `room` is the size of the largest grid O.
    MaxDepth(const gpu::Device&, vk::Extent2D room);

    struct Guides {
        gpu::View depth;   ///< R32_SFLOAT: linear view depth, 0 = background
        gpu::View normal;  ///< R32_UINT: packNormal
    };
    /// Halves `times` (1 … 3) times. Reads the extent of `full.depth`; writes ⌈extent / 2^times⌉
    /// texels of `out`. Pass "max depth".
    void record(gpu::Recorder&, const Guides& full, std::uint32_t times, const Guides& out) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
    std::vector<gpu::Image> depths, normals;  // between, each half of the one before
};

}  // namespace lodestar::post

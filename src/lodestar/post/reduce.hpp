// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::post {

/// How a supersampled picture is filtered down.
enum class ReduceFilter {
    box,       ///< the mean of a pixel's own samples
    mitchell,  ///< Mitchell & Netravali 1988 over two pixels to either side: sharper, less aliased
};

/// Filters a picture of n times the size down.
class Reduce {
public:
    explicit Reduce(const gpu::Device&);

    /// Writes every texel of `small` (RGBA16_SFLOAT) from `large`, any float format, n times its
    /// size on both sides. Pass "reduce". Throws std::invalid_argument for other sizes.
    void record(gpu::Recorder&, gpu::View large, ReduceFilter, gpu::View small) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::post

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scale/filter.hpp>

namespace lodestar::scale {

struct SpatialOptions {
    Filter filter = Filter::edgeAdaptive;
    float grain = 0.06f;     ///< Filter::noise: largest change, as a share of the range of codes
    float offset = 0.5f;     ///< Filter::noiseOffset: largest offset [texels of the source]
    std::uint32_t seed = 0;  ///< of both: the same picture twice for the same seed
};

/// Scales the live part of a picture to the size of another (dynamic resolution: the source is a
/// viewport of a larger target).
class Spatial {
public:
    explicit Spatial(const gpu::Device&);

    /// Writes every texel of `output` (RGBA8_UNORM, storage) from the part of `source` (sampled,
    /// of floats or unorms) that starts at its first texel and has the size `live`. What lies
    /// outside that part is never read into the result, not even weighted by 0. No filter changes
    /// a picture when both sizes are the same, but those with noise; where the source is larger
    /// than the output in both directions edge-adaptive is bilinear. Colours are filtered as they
    /// are stored: give it the picture after tone mapping. Pass "scale".
    /// Throws std::invalid_argument for a `live` that is 0 or larger than the source, and amounts
    /// of noise outside 0 … 1.
    void record(gpu::Recorder&, gpu::View source, vk::Extent2D live, const SpatialOptions&,
                gpu::View output) const;

private:
    vk::raii::Sampler linearSampler;
    std::vector<gpu::Kernel> kernels;  // one for each Filter: a change of it builds nothing
};

}  // namespace lodestar::scale

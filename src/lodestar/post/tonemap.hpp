// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::post {

/// Linear radiance → sRGB-encoded picture, by the ACES filmic curve.
class Tonemap {
public:
    explicit Tonemap(const gpu::Device&);

    /// Writes every texel in the extent of `display` (RGBA8_UNORM, sRGB-encoded). `exposure`
    /// multiplies radiance. The alpha of `radiance` is the share of the curve: 1 = all of it, 0 =
    /// none, the exposed colour is shown as it is (unlit surfaces).
    void record(gpu::Recorder&, gpu::View radiance, float exposure, gpu::View display) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::post

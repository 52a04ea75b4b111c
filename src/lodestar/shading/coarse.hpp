// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::shading {

/// Size of grid S: ⌈W/r⌉ × ⌈H/r⌉.
vk::Extent2D coarseExtent(vk::Extent2D full, float rate);

/// The expensive, smooth terms: soft sun shadow and sky irradiance, evaluated on grid S from
/// visibility (Yang et al. 2008, §2.3, fine-grained resizing).
class Coarse {
public:
    explicit Coarse(const gpu::Device&);

    struct Inputs {
        gpu::View ids;             ///< grid O, R32_UINT: triangle ids
        gpu::View shadowMap;       ///< D32_SFLOAT, reversed
        const gpu::Buffer& view;   ///< shared::ViewParams
        const gpu::Buffer& light;  ///< shared::LightParams
        /// RG32_SFLOAT, of the extent of `ids`, for recordFull: where each is met, in NDC; none: at
        /// the centres of pixels
        std::optional<gpu::View> points = {};
    };
    /// Writes the part of `coarse` (RGBA32_UINT) that coarseExtent(ids, rate) names.
    void record(gpu::Recorder&, const scene::GpuScene&, const Inputs&, float rate,
                gpu::View coarse) const;
    /// r = 1: writes the terms of every pixel of O to `terms` (RGBA16_SFLOAT), nothing to upsample.
    void recordFull(gpu::Recorder&, const scene::GpuScene&, const Inputs&, gpu::View terms) const;

private:
    void recordWith(gpu::Recorder&, const gpu::Kernel&, const scene::GpuScene&, const Inputs&,
                    float rate, gpu::View out) const;

    vk::raii::Sampler pointSampler;
    gpu::Kernel coarseKernel, fullKernel, pointKernel;
};

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::shading {

/// Size of grid S: ⌈W/r⌉ × ⌈H/r⌉.
vk::Extent2D coarseExtent(vk::Extent2D full, float rate);

/// The expensive, smooth terms: how much of the sun (soft shadow) and of the sky (ambient
/// occlusion) a surface sees, evaluated on grid S from visibility (Yang et al. 2008, §2.3,
/// fine-grained resizing).
class Coarse {
public:
    explicit Coarse(const gpu::Device&);

    struct Inputs {
        gpu::View ids;             ///< grid O, R32_UINT: triangle ids
        gpu::View sunMap;          ///< D32_SFLOAT array of one layer, reversed
        gpu::View skyMaps;         ///< D32_SFLOAT array, a layer for each view of the sky
        const gpu::Buffer& view;   ///< shared::ViewParams
        const gpu::Buffer& light;  ///< shared::LightParams
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
    gpu::Kernel coarseKernel, fullKernel;
};

}  // namespace lodestar::shading

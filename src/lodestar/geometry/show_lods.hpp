// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::geometry {

/// Colours a picture by level of detail: red, green, blue, then a ramp (Rakos 2010's F4 key).
class ShowLods {
public:
    explicit ShowLods(const gpu::Device&);

    /// `ids` (R32_UINT, sampled) of the view culled last; `picture` (RGBA8 storage) of the same
    /// size is read and written.
    void record(gpu::Recorder&, const scene::GpuScene&, gpu::View ids, gpu::View picture) const;

private:
    vk::raii::Sampler sampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::geometry

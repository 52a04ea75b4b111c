// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/scene/camera.hpp>
#include <lodestar/visibility/capture_ss.hpp>
#include <lodestar/visibility/rebuild.hpp>

namespace lodestar::app {

/// A plain G-buffer: what visibility::Surface holds, in the same formats, as render targets.
struct GBufferTargets {
    GBufferTargets(const gpu::Device&, vk::Extent2D);

    gpu::Image depth, normal, material, emissive;  ///< see visibility::Surface
    gpu::Image depthBuffer;
};

/// Draws surface attributes with the raster pipeline in one pass, the same vertices fetched the
/// same way as visibility::CaptureSs fetches them. The yardstick of visibility::Rebuild; not a part
/// of the frame.
class GBuffer {
public:
    GBuffer(const gpu::Device&, const scene::SceneFeatures&);

    /// Clears the targets and draws `list`, which the caller has made visible to raster and
    /// indirect. Pass "gbuffer".
    void record(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList&,
                const scene::Camera&, const GBufferTargets&) const;

private:
    bool emits;
    vk::raii::Sampler sampler;
    std::vector<gpu::RasterPipeline> pipelines;  ///< one for each scene::DrawBin
};

/// The same surface attributes two ways, each a frame of its own, to be timed in turn.
class AttributeComparison {
public:
    AttributeComparison(const gpu::Device&, const scene::GpuScene&, vk::Extent2D);

    /// Passes "capture" and "rebuild" (after "cull" and its kin).
    gpu::FrameTimes fromVisibility(const scene::Camera&);
    /// Passes "gbuffer" and "read": the attributes written, then all of them loaded once.
    gpu::FrameTimes fromGBuffer(const scene::Camera&);

    const visibility::Surface& rebuilt() const { return surface; }
    const GBufferTargets& drawn() const { return targets; }

private:
    void cullFor(const scene::Camera&);
    glm::mat4 clipFromWorld(const scene::Camera&) const;

    const scene::GpuScene* scene;
    vk::Extent2D extent;
    geometry::Cull cull;
    visibility::CaptureSs capture;
    visibility::Rebuild rebuild;
    GBuffer gbuffer;
    vk::raii::Sampler pointSampler;
    gpu::Kernel readKernel;
    geometry::DrawList list;
    gpu::Buffer viewBuffer;
    gpu::Image ids, depthBuffer, sums;
    visibility::Surface surface;
    GBufferTargets targets;
    gpu::Recorder rec;
};

}  // namespace lodestar::app

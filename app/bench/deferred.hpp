// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/frame/capture_frame.hpp>

namespace lodestar::app {

/// What a renderer's pixel shows, read back: of the reference, or rebuilt from a record.
struct Attributes {
    vk::Extent2D size;
    std::vector<float> depth;            ///< linear; 0 = background
    std::vector<std::uint8_t> albedo;    ///< rgba, square roots
    std::vector<std::uint32_t> normals;  ///< packNormal, world
    std::vector<std::uint32_t> ids;      ///< triangles
    std::vector<std::uint8_t> color;     ///< rgba, shaded
};

/// REF: plain deferred shading from a G-buffer of 16 bytes a pixel (linear depth, albedo, normal,
/// object). For comparison alone.
class DeferredReference {
public:
    DeferredReference(const gpu::Device&, const scene::GpuScene&, vk::Extent2D);

    /// Passes "cull", "gbuffer" and "shade".
    gpu::FrameTimes render(const scene::Camera&, float aspect);
    Attributes read() const;
    /// Of the G-buffer itself, and of everything it needs at that size.
    std::uint64_t gbufferBytes() const;
    std::uint64_t targetBytes() const;

private:
    const gpu::Device* device;
    const scene::GpuScene* scene;
    geometry::Cull cull;
    geometry::DrawList list;
    vk::raii::Sampler sampler, pointSampler;
    std::vector<gpu::RasterPipeline> pipelines;
    gpu::Kernel shade;
    gpu::Image depth, albedo, normal, id, depthBuffer, color;
    gpu::Recorder rec;
};

/// The same picture from a compact record at its capture rate: captured, compacted, and shaded
/// straight from heads and nodes.
class RecordRenderer {
public:
    RecordRenderer(const gpu::Device&, const scene::GpuScene&, const frame::CaptureSettings&);

    /// The capture's passes and "shade". Grows the node pool until the frame fits.
    gpu::FrameTimes render(const scene::Camera&, float aspect);
    /// Renders the attributes too.
    Attributes read(const scene::Camera&, float aspect);
    const frame::CaptureFrame& capture() const { return capturer; }

private:
    void recordShade(gpu::Recorder&, const gpu::Kernel&, const scene::Camera&, float aspect);

    const gpu::Device* device;
    const scene::GpuScene* scene;
    frame::CaptureFrame capturer;
    vk::raii::Sampler sampler;
    gpu::Kernel shade, attributes;
    gpu::Image color, noDepth, noIds;  // the last two stand where nothing is written
    gpu::Recorder rec;
    struct Targets {
        gpu::Image depth, albedo, normal, id;
    };
    std::optional<Targets> targets;
};

}  // namespace lodestar::app

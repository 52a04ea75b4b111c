// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::visibility {

/// The attributes of the visible surface at every pixel of a grid.
struct Surface {
    Surface(const gpu::Device&, vk::Extent2D);
    /// Depth and normal alone, for a Rebuild of guides: of the rest there is one texel.
    static Surface guides(const gpu::Device&, vk::Extent2D);

    gpu::Image depth;     ///< R32_SFLOAT: linear view depth [scene units]; 0 = background
    gpu::Image normal;    ///< R32_UINT: vertex normal in view space, packNormal
    gpu::Image material;  ///< RGBA32_UINT, see below; undefined on the background
    gpu::Image emissive;  ///< RGBA16_SFLOAT, linear; written only for scenes that emit
    // material.x: sqrt(albedo) rgb, occlusion (unorm 8)   .y: roughness, metallic (unorm 8), flags
    // << 16 material.z: shading normal, world, packNormal       .w: vertex normal, world,
    // packNormal

private:
    Surface(const gpu::Device&, vk::Extent2D guides, vk::Extent2D rest);
};

/// Rebuilds surface attributes from triangle ids: barycentrics from homogeneous edge functions,
/// texture gradients from their analytic derivatives (thesis §3.3, with the formulas of the
/// design).
class Rebuild {
public:
    /// `guidesAlone`: depth and normal are all that is written.
    Rebuild(const gpu::Device&, const scene::SceneFeatures&, bool guidesAlone = false);

    struct Inputs {
        gpu::View ids;            ///< R32_UINT, sampled: geometry's triangle ids, 0 = background
        const gpu::Buffer& view;  ///< shared::ViewParams
        /// RG32_SFLOAT, of the extent of `ids`: where each pixel is met, in NDC; none: at its
        /// centre
        std::optional<gpu::View> points = {};
        vk::Extent2D grid = {};  ///< O, whose pixels decide mip levels; none: the extent of `ids`
        glm::vec2 textureScale{1};  ///< of texture gradients along x, y: an LOD bias is its log2
        const char* pass = "rebuild";
        const gpu::TileList* tiles = nullptr;  ///< of `ids`; none: all
    };
    /// Writes every texel of `surface` that lies in the extent of `ids`, and in `tiles`.
    void record(gpu::Recorder&, const scene::GpuScene&, const Inputs&,
                const Surface& surface) const;

private:
    vk::raii::Sampler textureSampler, pointSampler;
    gpu::Kernel kernel, pointKernel;
};

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/frame/light_maps.hpp>
#include <lodestar/shading/coarse.hpp>
#include <lodestar/shading/combine.hpp>
#include <lodestar/shading/layer.hpp>
#include <lodestar/visibility/peel.hpp>
#include <lodestar/visibility/rebuild.hpp>

namespace lodestar::frame {

/// The surfaces of BLEND materials over the opaque picture, at a scale of their own.
class BlendedLayer {
public:
    /// `room` is the size of the largest grid O.
    BlendedLayer(const gpu::Device&, const scene::GpuScene&, vk::Extent2D room);

    /// What shades them, as it does what is opaque.
    struct Shading {
        const visibility::Rebuild& rebuild;
        const shading::Coarse& coarse;
        const shading::Combine& combine;
        const LightMaps& lightMaps;
        const gpu::Buffer &view, &light;
        gpu::View sky;
    };
    struct Over {
        gpu::View depth;     ///< R32_SFLOAT, linear: of what is opaque
        gpu::View radiance;  ///< RGBA16_SFLOAT
        float scale = 1;     ///< of the layer's grid, 0.25 … 1
        glm::vec2 textureScale{1};
        geometry::LodChoice lod;
        std::optional<vk::Extent2D> shown = {};  ///< see geometry::CullView
    };
    /// Blends them over the picture. Submits what was recorded, to see how many fragments there are
    /// to shade, and goes on: returns what that took. Culls into TablePart::light.
    gpu::FrameTimes blend(gpu::Recorder&, const scene::GpuScene&, const geometry::Cull&,
                          const Shading&, const Over&);

    /// How much of a pixel of the last picture is the layer's (R32_SFLOAT).
    const gpu::Image& coverage() const { return coverageImage; }
    /// Of the last picture: fragments shaded.
    std::uint32_t fragmentCount() const { return fragments->found(); }

private:
    void makeRoom(std::uint32_t capacity);
    std::uint32_t mostOf(vk::Extent2D size) const;
    void shade(gpu::Recorder&, const scene::GpuScene&, const Shading&, const Over&,
               vk::Extent2D size);

    const gpu::Device* device;
    visibility::Peel peel;
    shading::Layer layer;
    geometry::DrawList list;
    visibility::Peel::Targets peeled;
    shading::Layer::Targets targets;
    gpu::Image coverageImage;
    std::optional<shading::Layer::Fragments> fragments;
    std::optional<visibility::Surface> surfaces;  // of the fragments, as the next two
    std::optional<gpu::Image> terms, radiance;
};

}  // namespace lodestar::frame

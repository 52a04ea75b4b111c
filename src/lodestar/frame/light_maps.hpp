// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <lodestar/geometry/cull.hpp>
#include <lodestar/shading/light_views.hpp>
#include <lodestar/visibility/capture_ss.hpp>

namespace lodestar::frame {

/// The depth maps of the sun and of the sky's directions, redrawn when what they show has changed.
class LightMaps {
public:
    struct Settings {
        std::uint32_t sunTexels = 2048, skyTexels = 512;  ///< a side
        std::uint32_t skyViews = 16;                      ///< 0: no occlusion of the sky
        bool shadows = true;
        float shadowDistance = 0;  ///< [scene units]; 0 = to the far side of the scene
        geometry::LodChoice lod;   ///< in texels of the maps, whatever the eye sees: they are kept
    };
    LightMaps(const gpu::Device&, const scene::GpuScene&, const shading::Sky&, const Settings&);

    /// Redraws what is stale: the sun's map when the scene or its fit to the camera has changed,
    /// the sky's when the scene has, all when `scale` has. The maps are left visible to compute.
    /// `scale` (0.25 … 1): share of the texels a side that are drawn and read, in the corner of the
    /// images. Filters are as many texels wide as ever, so shadows are softer.
    void update(gpu::Recorder&, const scene::GpuScene&, const geometry::Cull&, const scene::Camera&,
                float aspect, float scale = 1);

    const gpu::Image& sunMap() const { return sunImage; }
    const gpu::Image& skyMaps() const { return skyImage; }
    const shading::LightView& sun() const { return sunView; }
    const std::vector<shading::LightView>& sky() const { return skyViews; }

private:
    void draw(gpu::Recorder&, const scene::GpuScene&, const geometry::Cull&,
              const shading::LightView&, gpu::View map, const std::string& name);

    Settings options;
    shading::Sky light;
    visibility::CaptureSs capture;
    geometry::DrawList list;
    gpu::Image sunImage, skyImage;
    shading::LightView sunView;
    std::vector<shading::LightView> skyViews;
    std::optional<std::uint64_t> sunVersion, skyVersion;  ///< of the scene the maps show
    float drawnScale = 1;
};

}  // namespace lodestar::frame

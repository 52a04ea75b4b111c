// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/light_maps.hpp>

#include <algorithm>

#include <lodestar/frame/targets.hpp>

namespace lodestar::frame {
namespace {

using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

gpu::Image depthMaps(const gpu::Device& device, std::uint32_t texels, std::uint32_t layers,
                     const char* name) {
    return {device,
            {.name = name,
             .format = vk::Format::eD32Sfloat,
             .extent = {texels, texels},
             .usage = Usage::eSampled | Usage::eTransferSrc | Usage::eDepthStencilAttachment,
             .layers = std::max(layers, 1u),
             .array = true}};
}

}  // namespace

LightMaps::LightMaps(const gpu::Device& device, const scene::GpuScene& scene,
                     const shading::Sky& sky, const Settings& settings)
    : options(settings),
      light(sky),
      capture(device, scene.features(), visibility::CaptureSs::Writes::depthOnly),
      list(device, scene, "light", scene::TablePart::light),
      sunImage(depthMaps(device, settings.sunTexels, 1, "sun map")),
      skyImage(depthMaps(device, settings.skyTexels, settings.skyViews, "sky maps")) {}

void LightMaps::update(gpu::Recorder& rec, const scene::GpuScene& scene, const geometry::Cull& cull,
                       const scene::Camera& camera, float aspect, float scale) {
    const std::uint64_t version = scene.version();
    if (scale != drawnScale) {
        sunVersion.reset();
        skyVersion.reset();
        drawnScale = scale;
    }
    const auto texels = [scale](std::uint32_t all) { return scaled({all, all}, scale).width; };
    const auto live = [&](gpu::View map) { return part(map, scaled(map.extent, scale)); };
    if (options.shadows) {
        const scene::Bounds& bounds = scene.bounds();
        const float toScene = bounds.empty() ? 1 : glm::distance(camera.eye, bounds.centre());
        // To the far side of the scene, wherever in it the eye is.
        const float distance =
            options.shadowDistance > 0 ? options.shadowDistance : toScene + bounds.radius();
        const shading::LightView now = shading::fitSun(light.toSun(), bounds, camera, aspect,
                                                       distance, texels(options.sunTexels));
        if (!(now == sunView) || sunVersion != version) {
            sunView = now;
            sunVersion = version;
            draw(rec, scene, cull, sunView, live(sunImage.layer(0)), "shadow map");
        }
    }

    if (skyVersion != version) {
        skyVersion = version;
        skyViews =
            shading::fitSky(light, scene.bounds(), options.skyViews, texels(options.skyTexels));
        for (std::uint32_t i = 0; i < options.skyViews; ++i)
            draw(rec, scene, cull, skyViews[i], live(skyImage.layer(i)), "sky map");
    }
}

void LightMaps::draw(gpu::Recorder& rec, const scene::GpuScene& scene, const geometry::Cull& cull,
                     const shading::LightView& view, gpu::View map, const std::string& name) {
    rec.barrier(Stage::raster, Stage::compute);  // the list may be in use for the map before
    rec.barrier(Stage::indirect, Stage::compute);
    cull.record(rec, scene,
                {.clipFromWorld = view.clipFromWorld,
                 .size = map.extent,
                 .perspective = false,
                 .keepBeforeNear = true,
                 .lod = options.lod},
                list);
    rec.barrier(Stage::compute, Stage::raster);
    rec.barrier(Stage::compute, Stage::indirect);
    capture.record(rec, scene, list, view.clipFromWorld, {{}, map}, name);
    rec.barrier(Stage::raster, Stage::compute);
}

}  // namespace lodestar::frame

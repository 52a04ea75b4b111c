// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/rebuild_params.h>
#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/visibility/capture_ss.hpp>
#include <lodestar/visibility/rebuild.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/visibility/rebuild.comp.inc>
    ;

using gpu::Slot;

gpu::Image surfaceImage(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                        const char* name) {
    using Usage = vk::ImageUsageFlagBits;
    return {device,
            {.name = name,
             .format = format,
             .extent = extent,
             .usage = Usage::eStorage | Usage::eSampled | Usage::eTransferSrc}};
}

gpu::Specialization constants(const scene::SceneFeatures& f, bool points, bool guidesAlone) {
    return {f.uvTransforms,
            f.baseColorArrays,
            f.normalArrays,
            f.metallicRoughnessArrays,
            f.occlusionShared ? 0 : f.occlusionArrays,
            f.emissiveArrays,
            f.occlusionShared,
            f.emissive,
            points,
            guidesAlone};
}

gpu::Kernel makeKernel(const gpu::Device& device, const scene::SceneFeatures& features, bool points,
                       bool guidesAlone) {
    return {device,
            points ? "rebuild at points" : "rebuild",
            kCode,
            scene::withSceneSlots({Slot::uniformBuffer,
                                   Slot::sampledImage,
                                   Slot::storageImage,
                                   Slot::storageImage,
                                   Slot::storageImage,
                                   Slot::storageImage,
                                   Slot::texelBuffer,
                                   {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                   Slot::texelBuffer,
                                   Slot::sampledImage,
                                   Slot::texelBuffer}),
            sizeof(shared::RebuildParams),
            constants(features, points, guidesAlone)};
}

}  // namespace

Surface::Surface(const gpu::Device& device, vk::Extent2D extent)
    : Surface(device, extent, extent) {}

Surface Surface::guides(const gpu::Device& device, vk::Extent2D extent) {
    return {device, extent, {1, 1}};
}

Surface::Surface(const gpu::Device& device, vk::Extent2D guides, vk::Extent2D rest)
    : depth(surfaceImage(device, guides, vk::Format::eR32Sfloat, "surface: depth")),
      normal(surfaceImage(device, guides, vk::Format::eR32Uint, "surface: normal")),
      material(surfaceImage(device, rest, vk::Format::eR32G32B32A32Uint, "surface: material")),
      emissive(surfaceImage(device, rest, vk::Format::eR16G16B16A16Sfloat, "surface: emissive")) {}

Rebuild::Rebuild(const gpu::Device& device, const scene::SceneFeatures& features, bool guidesAlone)
    : textureSampler(makeTextureSampler(device)),
      pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(makeKernel(device, features, false, guidesAlone)),
      pointKernel(makeKernel(device, features, true, guidesAlone)) {}

void Rebuild::record(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                     const Surface& out) const {
    const auto pass = rec.pass(in.pass);
    const vk::Extent2D grid = in.grid.width > 0 ? in.grid : in.ids.extent;
    const shared::RebuildParams params{
        .pixelNdc = {2 / static_cast<float>(grid.width), 2 / static_cast<float>(grid.height)},
        .size = {in.ids.extent.width, in.ids.extent.height},
        .textureScale = in.textureScale};
    // Without points that binding is not read: any image of floats does.
    const gpu::View points = in.points ? *in.points : out.depth.view();
    rec.dispatchTiles(in.points ? pointKernel : kernel, in.ids.extent, in.tiles,
                      scene::withScene(scene, {in.view,
                                               {in.ids, pointSampler},
                                               out.depth,
                                               out.normal,
                                               out.material,
                                               out.emissive,
                                               scene.materials,
                                               {scene.textureViews(), textureSampler},
                                               scene.secondUvs,
                                               {points, pointSampler}}),
                      params);
}

}  // namespace lodestar::visibility

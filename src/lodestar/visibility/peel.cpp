// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/peel.hpp>

#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/visibility/capture_ss.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kVertexCode[] =
#include <lodestar/visibility/capture_ss.vert.inc>
    ;
constexpr std::uint32_t kFragmentCode[] =
#include <lodestar/visibility/peel.frag.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using scene::DrawBin;
using Usage = vk::ImageUsageFlagBits;

constexpr DrawBin kBins[] = {DrawBin::masked, DrawBin::maskedDoubleSided};

gpu::RasterPipeline makePipeline(const gpu::Device& device, const scene::SceneFeatures& features,
                                 DrawBin bin, bool first) {
    const bool doubleSided = bin == DrawBin::maskedDoubleSided;
    return {device,
            gpu::RasterInfo{
                .name = doubleSided ? "peel, double-sided" : "peel",
                .vertex = kVertexCode,
                .fragment = kFragmentCode,
                .colors = {vk::Format::eR32Uint, vk::Format::eR32Sfloat},
                .cull = doubleSided ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack,
                .slots = scene::withSceneSlots({Slot::texelBuffer,
                                                Slot::texelBuffer,
                                                {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                                Slot::texelBuffer,
                                                Slot::sampledImage,
                                                Slot::sampledImage}),
                .pushBytes = sizeof(shared::PeelParams),
                .constants = {features.uvTransforms, 1, first, features.baseColorArrays}}};
}

std::vector<gpu::Image> images(const gpu::Device& device, std::size_t count, vk::Extent2D extent,
                               vk::Format format, vk::ImageUsageFlags usage, const char* name) {
    std::vector<gpu::Image> made;
    for (std::size_t i = 0; i < count; ++i)
        made.emplace_back(device,
                          gpu::ImageInfo{.name = name,
                                         .format = format,
                                         .extent = extent,
                                         .usage = usage | Usage::eSampled | Usage::eTransferSrc});
    return made;
}

}  // namespace

Peel::Targets::Targets(const gpu::Device& device, vk::Extent2D room)
    : ids(images(device, shared::LS_PEELS, room, vk::Format::eR32Uint, Usage::eColorAttachment,
                 "peel: ids")),
      alphas(images(device, shared::LS_PEELS, room, vk::Format::eR32Sfloat, Usage::eColorAttachment,
                    "peel: alphas")),
      depths(images(device, 2, room, vk::Format::eD32Sfloat, Usage::eDepthStencilAttachment,
                    "peel: depth")) {}

Peel::Peel(const gpu::Device& device, const scene::SceneFeatures& features)
    : sampler(makeTextureSampler(device)), pointSampler(device.vk(), vk::SamplerCreateInfo{}) {
    for (const DrawBin bin : kBins) {
        first.push_back(makePipeline(device, features, bin, true));
        further.push_back(makePipeline(device, features, bin, false));
    }
}

void Peel::record(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                  const Targets& to) const {
    const vk::Extent2D opaque = in.opaqueDepth.extent;
    const shared::PeelParams params{.clipFromWorld = in.clipFromWorld,
                                    .textureScale = in.textureScale,
                                    .toOpaque = glm::vec2(opaque.width, opaque.height) /
                                                glm::vec2(in.size.width, in.size.height),
                                    .opaqueSize = {opaque.width, opaque.height}};
    for (std::uint32_t layer = 0; layer < shared::LS_PEELS; ++layer) {
        const gpu::View depth = part(to.depths[layer % 2], in.size);
        const gpu::View before = part(to.depths[1 - layer % 2], in.size);
        {
            const auto pass = rec.pass("peel");
            rec.beginRendering(
                {.colors = {part(to.ids[layer], in.size), part(to.alphas[layer], in.size)},
                 .depth = depth});
            const auto bindings = scene::withScene(scene, {in.list.ids,
                                                           scene.materials,
                                                           {scene.textureViews(), sampler},
                                                           scene.secondUvs,
                                                           {in.opaqueDepth, pointSampler},
                                                           {before, pointSampler}});
            for (std::size_t i = 0; i < std::size(kBins); ++i) {
                const auto bin = static_cast<std::size_t>(kBins[i]);
                if (scene.binStarts()[bin] == scene.binStarts()[bin + 1]) continue;
                rec.drawIndirect(layer == 0 ? first[i] : further[i], in.list.draws,
                                 bin * sizeof(vk::DrawIndirectCommand), bindings, params);
            }
            rec.endRendering();
        }
        rec.barrier(Stage::raster, Stage::raster);
    }
    rec.barrier(Stage::raster, Stage::compute);
}

}  // namespace lodestar::visibility

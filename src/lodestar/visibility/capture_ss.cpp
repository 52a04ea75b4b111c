// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/capture_ss_params.h>
#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/visibility/capture_ss.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kVertexCode[] =
#include <lodestar/visibility/capture_ss.vert.inc>
    ;
constexpr std::uint32_t kFragmentCode[] =
#include <lodestar/visibility/capture_ss.frag.inc>
    ;

using gpu::Slot;
using scene::DrawBin;

gpu::RasterPipeline makePipeline(const gpu::Device& device, const scene::SceneFeatures& features,
                                 CaptureSs::Writes writes, DrawBin bin) {
    const bool ids = writes == CaptureSs::Writes::idsAndDepth;
    const bool masked = bin == DrawBin::masked || bin == DrawBin::maskedDoubleSided;
    const bool doubleSided = bin == DrawBin::opaqueDoubleSided || bin == DrawBin::maskedDoubleSided;
    gpu::RasterInfo info{
        .name = std::string(ids ? "capture" : "depth") + (masked ? ", masked" : "") +
                (doubleSided ? ", double-sided" : ""),
        .vertex = kVertexCode,
        .cull = doubleSided ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack,
        .depthClamp = !ids,
        .slots = scene::withSceneSlots({Slot::texelBuffer,
                                        Slot::texelBuffer,
                                        {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                        Slot::texelBuffer}),
        .pushBytes = sizeof(shared::CaptureParams),
        .constants = {features.uvTransforms, masked, ids, features.baseColorArrays}};
    if (ids) info.colors = {vk::Format::eR32Uint};
    if (ids || masked) info.fragment = kFragmentCode;
    return {device, info};
}

}  // namespace

vk::raii::Sampler makeTextureSampler(const gpu::Device& device) {
    // On a CPU driver anisotropic filtering costs more than it gives.
    const bool anisotropic = device.hasAnisotropy() && device.description().type != "Cpu";
    return {device.vk(), vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear,
                                               .minFilter = vk::Filter::eLinear,
                                               .mipmapMode = vk::SamplerMipmapMode::eLinear,
                                               .anisotropyEnable = anisotropic,
                                               .maxAnisotropy = 8,
                                               .maxLod = VK_LOD_CLAMP_NONE}};
}

CaptureSs::CaptureSs(const gpu::Device& device, const scene::SceneFeatures& features, Writes what)
    : writes(what), sampler(makeTextureSampler(device)) {
    for (std::size_t bin = 0; bin < scene::kDrawBins; ++bin)
        pipelines.push_back(makePipeline(device, features, writes, DrawBin(bin)));
}

void CaptureSs::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                       const geometry::DrawList& list, const glm::mat4& clipFromWorld,
                       const Target& target, const std::string& name, Phase phase) const {
    const auto pass = rec.pass(name);
    gpu::Recorder::Target attachments{
        .colors = {}, .depth = target.depth, .keep = phase == Phase::second};
    if (writes == Writes::idsAndDepth) attachments.colors = {target.ids};
    rec.beginRendering(attachments);
    if (target.viewport) rec.vk().setViewport(0, *target.viewport);
    const auto bindings = scene::withScene(
        scene, {list.ids, scene.materials, {scene.textureViews(), sampler}, scene.secondUvs});
    for (std::uint32_t bin = 0; bin < scene::kDrawBins; ++bin) {
        if (scene.binStarts()[bin] == scene.binStarts()[bin + 1]) continue;
        for (const Phase own : {Phase::first, Phase::second}) {
            if (phase != Phase::both && phase != own) continue;
            const std::size_t draw = bin + (own == Phase::second ? scene::kDrawBins : 0);
            rec.drawIndirect(pipelines[bin], list.draws, draw * sizeof(vk::DrawIndirectCommand),
                             bindings, shared::CaptureParams{clipFromWorld, target.textureScale});
        }
    }
    rec.endRendering();
}

}  // namespace lodestar::visibility

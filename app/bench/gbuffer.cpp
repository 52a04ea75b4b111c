// SPDX-License-Identifier: Apache-2.0
#include "app/bench/gbuffer.hpp"

#include <lodestar/visibility/view_params.h>
#include <lodestar/scene/scene_bindings.hpp>

#include "app/bench/gbuffer_params.h"

namespace lodestar::app {
namespace {

constexpr std::uint32_t kVertexCode[] =
#include <app/bench/gbuffer.vert.inc>
    ;
constexpr std::uint32_t kFragmentCode[] =
#include <app/bench/gbuffer.frag.inc>
    ;
constexpr std::uint32_t kReadCode[] =
#include <app/bench/gbuffer_read.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using scene::DrawBin;
using Usage = vk::ImageUsageFlagBits;

gpu::Image image(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                 const char* name, vk::ImageUsageFlags usage) {
    return {device,
            {.name = name,
             .format = format,
             .extent = extent,
             .usage = usage | Usage::eSampled | Usage::eTransferSrc}};
}

std::vector<vk::Format> colorFormats(bool emits) {
    std::vector formats{vk::Format::eR32Sfloat, vk::Format::eR32Uint,
                        vk::Format::eR32G32B32A32Uint};
    if (emits) formats.push_back(vk::Format::eR16G16B16A16Sfloat);
    return formats;
}

gpu::RasterPipeline makePipeline(const gpu::Device& device, const scene::SceneFeatures& f,
                                 DrawBin bin) {
    const bool masked = bin == DrawBin::masked || bin == DrawBin::maskedDoubleSided;
    const bool doubleSided = bin == DrawBin::opaqueDoubleSided || bin == DrawBin::maskedDoubleSided;
    return {device,
            {.name = std::string("gbuffer") + (masked ? ", masked" : "") +
                     (doubleSided ? ", double-sided" : ""),
             .vertex = kVertexCode,
             .fragment = kFragmentCode,
             .colors = colorFormats(f.emissive),
             .cull = doubleSided ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack,
             .slots = scene::withSceneSlots({Slot::texelBuffer,
                                             {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                             Slot::texelBuffer, Slot::texelBuffer}),
             .pushBytes = sizeof(shared::GBufferParams),
             .constants = {f.uvTransforms, masked, f.baseColorArrays, f.normalArrays,
                           f.metallicRoughnessArrays, f.occlusionShared ? 0 : f.occlusionArrays,
                           f.emissiveArrays, f.occlusionShared, f.emissive}}};
}

}  // namespace

GBufferTargets::GBufferTargets(const gpu::Device& device, vk::Extent2D extent)
    : depth(
          image(device, extent, vk::Format::eR32Sfloat, "gbuffer: depth", Usage::eColorAttachment)),
      normal(
          image(device, extent, vk::Format::eR32Uint, "gbuffer: normal", Usage::eColorAttachment)),
      material(image(device, extent, vk::Format::eR32G32B32A32Uint, "gbuffer: material",
                     Usage::eColorAttachment)),
      emissive(image(device, extent, vk::Format::eR16G16B16A16Sfloat, "gbuffer: emissive",
                     Usage::eColorAttachment)),
      depthBuffer(image(device, extent, vk::Format::eD32Sfloat, "gbuffer: depth buffer",
                        Usage::eDepthStencilAttachment)) {}

GBuffer::GBuffer(const gpu::Device& device, const scene::SceneFeatures& features)
    : emits(features.emissive), sampler(visibility::makeTextureSampler(device)) {
    for (std::size_t bin = 0; bin < scene::kDrawBins; ++bin)
        pipelines.push_back(makePipeline(device, features, DrawBin(bin)));
}

void GBuffer::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                     const geometry::DrawList& list, const scene::Camera& camera,
                     const GBufferTargets& out) const {
    const auto pass = rec.pass("gbuffer");
    const vk::Extent2D extent = out.depth.extent();
    const glm::mat4 viewFromWorld = camera.viewFromWorld();
    const glm::mat4 rows = glm::transpose(viewFromWorld);
    const shared::GBufferParams params{
        .clipFromWorld = camera.clipFromView(static_cast<float>(extent.width) /
                                             static_cast<float>(extent.height)) *
                         viewFromWorld,
        .viewRow0 = rows[0],
        .viewRow1 = rows[1],
        .viewRow2 = rows[2]};
    gpu::Recorder::Target target{.colors = {out.depth, out.normal, out.material},
                                 .depth = out.depthBuffer};
    if (emits) target.colors.push_back(out.emissive);
    rec.beginRendering(target);
    const auto bindings = scene::withScene(
        scene, {scene.materials, {scene.textureViews(), sampler}, scene.secondUvs, list.ids});
    for (std::uint32_t bin = 0; bin < scene::kDrawBins; ++bin) {
        if (scene.binStarts()[bin] == scene.binStarts()[bin + 1]) continue;
        rec.drawIndirect(pipelines[bin], list.draws, bin * sizeof(vk::DrawIndirectCommand),
                         bindings, params);
    }
    rec.endRendering();
}

AttributeComparison::AttributeComparison(const gpu::Device& device, const scene::GpuScene& gpuScene,
                                         vk::Extent2D size)
    : scene(&gpuScene),
      extent(size),
      cull(device),
      capture(device, gpuScene.features()),
      rebuild(device, gpuScene.features()),
      gbuffer(device, gpuScene.features()),
      pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      readKernel(device, "gbuffer read", kReadCode,
                 {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::sampledImage,
                  Slot::storageImage},
                 0, {gpuScene.features().emissive}),
      list(device, gpuScene, "comparison"),
      viewBuffer(device, "comparison: view", sizeof(shared::ViewParams), gpu::Residence::mapped),
      ids(image(device, size, vk::Format::eR32Uint, "comparison: ids", Usage::eColorAttachment)),
      depthBuffer(image(device, size, vk::Format::eD32Sfloat, "comparison: depth buffer",
                        Usage::eDepthStencilAttachment)),
      sums(image(device, size, vk::Format::eR32Uint, "comparison: sums", Usage::eStorage)),
      surface(device, size),
      targets(device, size),
      rec(device) {}

glm::mat4 AttributeComparison::clipFromWorld(const scene::Camera& camera) const {
    return camera.clipFromView(static_cast<float>(extent.width) /
                               static_cast<float>(extent.height)) *
           camera.viewFromWorld();
}

void AttributeComparison::cullFor(const scene::Camera& camera) {
    cull.record(rec, *scene, {clipFromWorld(camera), camera.eye, extent}, list);
    rec.barrier(Stage::compute, Stage::raster);
    rec.barrier(Stage::compute, Stage::indirect);
}

gpu::FrameTimes AttributeComparison::fromVisibility(const scene::Camera& camera) {
    const glm::mat4 clipFromView =
        camera.clipFromView(static_cast<float>(extent.width) / static_cast<float>(extent.height));
    *viewBuffer.mapped<shared::ViewParams>() = {
        .clipFromWorld = clipFromWorld(camera),
        .viewFromWorld = camera.viewFromWorld(),
        .eye = camera.eye,
        .clipScale = {clipFromView[0][0], clipFromView[1][1]}};
    rec.begin();
    cullFor(camera);
    capture.record(rec, *scene, list, clipFromWorld(camera), {ids, depthBuffer}, "capture");
    rec.barrier(Stage::raster, Stage::compute);
    rebuild.record(rec, *scene, {ids, viewBuffer}, surface);
    return rec.submit();
}

gpu::FrameTimes AttributeComparison::fromGBuffer(const scene::Camera& camera) {
    rec.begin();
    cullFor(camera);
    gbuffer.record(rec, *scene, list, camera, targets);
    rec.barrier(Stage::raster, Stage::compute);
    {
        const auto pass = rec.pass("read");
        rec.dispatch(readKernel, gpu::groups8x8(extent),
                     {{targets.depth, pointSampler},
                      {targets.normal, pointSampler},
                      {targets.material, pointSampler},
                      {targets.emissive, pointSampler},
                      sums});
    }
    return rec.submit();
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include "app/bench/deferred.hpp"

#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/scene_bindings.hpp>

#include "app/bench/deferred_params.h"
#include "app/bench/gbuffer_params.h"

namespace lodestar::app {
namespace {

constexpr std::uint32_t kVertexCode[] =
#include <app/bench/gbuffer.vert.inc>
    ;
constexpr std::uint32_t kFragmentCode[] =
#include <app/bench/gbuffer_16.frag.inc>
    ;
constexpr std::uint32_t kShadeCode[] =
#include <app/bench/deferred_shade.comp.inc>
    ;
constexpr std::uint32_t kRecordCode[] =
#include <app/bench/visibility_shade.comp.inc>
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

gpu::RasterPipeline makePipeline(const gpu::Device& device, const scene::SceneFeatures& f,
                                 DrawBin bin) {
    const bool masked = bin == DrawBin::masked || bin == DrawBin::maskedDoubleSided;
    const bool doubleSided = bin == DrawBin::opaqueDoubleSided || bin == DrawBin::maskedDoubleSided;
    return {device,
            {.name = std::string("16-byte gbuffer") + (masked ? ", masked" : "") +
                     (doubleSided ? ", double-sided" : ""),
             .vertex = kVertexCode,
             .fragment = kFragmentCode,
             .colors = {vk::Format::eR32Sfloat, vk::Format::eR8G8B8A8Unorm, vk::Format::eR32Uint,
                        vk::Format::eR32Uint},
             .cull = doubleSided ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack,
             .slots = scene::withSceneSlots({Slot::texelBuffer,
                                             {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                             Slot::texelBuffer,
                                             Slot::texelBuffer}),
             .pushBytes = sizeof(shared::GBufferParams),
             .constants = {f.uvTransforms, masked, f.baseColorArrays, f.normalArrays}}};
}

glm::mat4 clipOf(const scene::Camera& camera, float aspect) {
    return camera.clipFromView(aspect) * camera.viewFromWorld();
}

shared::PhongParams phongParams(const scene::Camera& camera, float aspect, vk::Extent2D base) {
    return {.clipFromWorld = clipOf(camera, aspect),
            .eye = camera.eye,
            .base = {base.width, base.height}};
}

gpu::Kernel recordKernel(const gpu::Device& device, const scene::SceneFeatures& f,
                         std::uint32_t side, bool attributes) {
    return {device,
            attributes ? "attributes from the record" : "shade from the record",
            kRecordCode,
            scene::withSceneSlots({Slot::texelBuffer,
                                   Slot::texelBuffer,
                                   Slot::storageImage,
                                   Slot::storageImage,
                                   Slot::storageImage,
                                   Slot::storageImage,
                                   Slot::texelBuffer,
                                   {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                   Slot::texelBuffer,
                                   Slot::storageImage}),
            sizeof(shared::PhongParams),
            {f.uvTransforms, f.baseColorArrays, f.normalArrays, side, attributes}};
}

template <typename T>
std::vector<T> texels(const gpu::Device& device, const gpu::Image& from) {
    return gpu::as<T>(gpu::readImage(device, from));
}

}  // namespace

DeferredReference::DeferredReference(const gpu::Device& owner, const scene::GpuScene& gpuScene,
                                     vk::Extent2D size)
    : device(&owner),
      scene(&gpuScene),
      cull(owner),
      list(owner, gpuScene, "reference"),
      sampler(visibility::makeTextureSampler(owner)),
      pointSampler(owner.vk(), vk::SamplerCreateInfo{}),
      shade(owner, "deferred shading", kShadeCode,
            {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::storageImage},
            sizeof(shared::PhongParams)),
      depth(image(owner, size, vk::Format::eR32Sfloat, "REF: depth", Usage::eColorAttachment)),
      albedo(
          image(owner, size, vk::Format::eR8G8B8A8Unorm, "REF: albedo", Usage::eColorAttachment)),
      normal(image(owner, size, vk::Format::eR32Uint, "REF: normal", Usage::eColorAttachment)),
      id(image(owner, size, vk::Format::eR32Uint, "REF: object", Usage::eColorAttachment)),
      depthBuffer(image(owner, size, vk::Format::eD32Sfloat, "REF: depth buffer",
                        Usage::eDepthStencilAttachment)),
      color(image(owner, size, vk::Format::eR8G8B8A8Unorm, "REF: colour", Usage::eStorage)),
      rec(owner) {
    for (std::size_t bin = 0; bin < scene::kDrawBins; ++bin)
        pipelines.push_back(makePipeline(owner, gpuScene.features(), DrawBin(bin)));
}

gpu::FrameTimes DeferredReference::render(const scene::Camera& camera, float aspect) {
    const glm::mat4 clip = clipOf(camera, aspect);
    rec.begin();
    cull.record(rec, *scene, {clip, camera.eye, depth.extent()}, list);
    rec.barrier(Stage::compute, Stage::raster);
    rec.barrier(Stage::compute, Stage::indirect);
    {
        const auto pass = rec.pass("gbuffer");
        const glm::mat4 rows = glm::transpose(camera.viewFromWorld());
        const shared::GBufferParams params{
            .clipFromWorld = clip, .viewRow0 = rows[0], .viewRow1 = rows[1], .viewRow2 = rows[2]};
        rec.beginRendering({.colors = {depth, albedo, normal, id}, .depth = depthBuffer});
        const auto bindings = scene::withScene(
            *scene,
            {scene->materials, {scene->textureViews(), sampler}, scene->secondUvs, list.ids});
        for (std::uint32_t bin = 0; bin < scene::kDrawBins; ++bin) {
            if (scene->binStarts()[bin] == scene->binStarts()[bin + 1]) continue;
            rec.drawIndirect(pipelines[bin], list.draws, bin * sizeof(vk::DrawIndirectCommand),
                             bindings, params);
        }
        rec.endRendering();
    }
    rec.barrier(Stage::raster, Stage::compute);
    {
        const auto pass = rec.pass("shade");
        rec.dispatch(shade, gpu::groups8x8(depth.extent()),
                     {{depth, pointSampler}, {albedo, pointSampler}, {normal, pointSampler}, color},
                     phongParams(camera, aspect, depth.extent()));
    }
    return rec.submit();
}

Attributes DeferredReference::read() const {
    return {.size = depth.extent(),
            .depth = texels<float>(*device, depth),
            .albedo = texels<std::uint8_t>(*device, albedo),
            .normals = texels<std::uint32_t>(*device, normal),
            .ids = texels<std::uint32_t>(*device, id),
            .color = texels<std::uint8_t>(*device, color)};
}

std::uint64_t DeferredReference::gbufferBytes() const {
    return 16ull * depth.extent().width * depth.extent().height;
}

std::uint64_t DeferredReference::targetBytes() const {
    return gbufferBytes() + 4ull * depth.extent().width * depth.extent().height;
}

RecordRenderer::RecordRenderer(const gpu::Device& owner, const scene::GpuScene& gpuScene,
                               const frame::CaptureSettings& settings)
    : device(&owner),
      scene(&gpuScene),
      capturer(owner, gpuScene, settings),
      sampler(visibility::makeTextureSampler(owner)),
      shade(recordKernel(owner, gpuScene.features(), settings.side, false)),
      attributes(recordKernel(owner, gpuScene.features(), settings.side, true)),
      color(image(owner, capturer.gridC(), vk::Format::eR8G8B8A8Unorm, "record: colour",
                  Usage::eStorage)),
      noDepth(image(owner, {1, 1}, vk::Format::eR32Sfloat, "record: unused", Usage::eStorage)),
      noIds(image(owner, {1, 1}, vk::Format::eR32Uint, "record: unused", Usage::eStorage)),
      rec(owner) {}

void RecordRenderer::recordShade(gpu::Recorder& r, const gpu::Kernel& kernel,
                                 const scene::Camera& camera, float aspect) {
    const auto pass = r.pass("shade");
    const auto& record = capturer.compact();
    const auto bindings = scene::withScene(
        *scene, {record.heads, record.lists, color, targets ? targets->depth : noDepth,
                 targets ? targets->albedo : color, targets ? targets->normal : noIds,
                 scene->materials, gpu::Binding(scene->textureViews(), sampler), scene->secondUvs,
                 targets ? targets->id : noIds});
    const std::uint32_t groups = gpu::groups(record.base.width * record.base.height, 64);
    const std::uint32_t lines = gpu::groups(groups, 32768);
    r.dispatch(kernel, {gpu::groups(groups, lines), lines, 1}, bindings,
               phongParams(camera, aspect, record.base));
}

gpu::FrameTimes RecordRenderer::render(const scene::Camera& camera, float aspect) {
    for (;;) {
        rec.begin();
        capturer.record(rec, camera);
        recordShade(rec, shade, camera, aspect);
        const gpu::FrameTimes times = rec.submit();
        if (!capturer.compact().overflowed()) return times;
        capturer.grow();
    }
}

Attributes RecordRenderer::read(const scene::Camera& camera, float aspect) {
    const vk::Extent2D size = capturer.gridC();
    render(camera, aspect);
    targets.emplace(
        Targets{image(*device, size, vk::Format::eR32Sfloat, "record: depth", Usage::eStorage),
                image(*device, size, vk::Format::eR8G8B8A8Unorm, "record: albedo", Usage::eStorage),
                image(*device, size, vk::Format::eR32Uint, "record: normal", Usage::eStorage),
                image(*device, size, vk::Format::eR32Uint, "record: ids", Usage::eStorage)});
    rec.begin();
    recordShade(rec, attributes, camera, aspect);
    rec.submit();
    Attributes result{.size = size,
                      .depth = texels<float>(*device, targets->depth),
                      .albedo = texels<std::uint8_t>(*device, targets->albedo),
                      .normals = texels<std::uint32_t>(*device, targets->normal),
                      .ids = texels<std::uint32_t>(*device, targets->id),
                      .color = texels<std::uint8_t>(*device, color)};
    targets.reset();
    return result;
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/capture_ms.hpp>

#include <fmt/format.h>

#include <lodestar/visibility/capture_ms_params.h>
#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/visibility/capture_ss.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kVertexCode[] =
#include <lodestar/visibility/capture_ss.vert.inc>
    ;
constexpr std::uint32_t kFragmentCode[] =
#include <lodestar/visibility/capture_ms.frag.inc>
    ;
constexpr std::uint32_t kGatherCode[] =
#include <lodestar/visibility/capture_ms.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using scene::DrawBin;
using Usage = vk::ImageUsageFlagBits;

MultisamplePlan checkedPlan(const gpu::Device& device, std::uint32_t side) {
    MultisamplePlan plan = planMultisample(device.multisamples(), side);
    if (plan.shifts.empty())
        throw gpu::DeviceError(
            fmt::format("{} has no multisampling that covers {} samples a pixel: capture by "
                        "supersampling instead",
                        device.description().name, side * side));
    return plan;
}

gpu::RasterPipeline makePipeline(const gpu::Device& device, const scene::SceneFeatures& features,
                                 std::uint32_t side, std::uint32_t samples, DrawBin bin) {
    const bool masked = bin == DrawBin::masked || bin == DrawBin::maskedDoubleSided;
    const bool doubleSided = bin == DrawBin::opaqueDoubleSided || bin == DrawBin::maskedDoubleSided;
    return {
        device,
        {.name = std::string("multisample capture") + (masked ? ", masked" : "") +
                 (doubleSided ? ", double-sided" : ""),
         .vertex = kVertexCode,
         .fragment = kFragmentCode,
         .colors = {vk::Format::eR8G8B8A8Unorm},
         .cull = doubleSided ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack,
         .samples = samples,
         .sampleShading = masked,
         .slots = scene::withSceneSlots({Slot::texelBuffer,
                                         Slot::texelBuffer,
                                         {Slot::sampledImage, shared::LS_TEXTURE_ARRAYS},
                                         Slot::texelBuffer}),
         .pushBytes = sizeof(shared::CaptureMsDrawParams),
         .constants = {features.uvTransforms, masked, side, samples, features.baseColorArrays}}};
}

gpu::Image target(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                  std::uint32_t samples, vk::ImageUsageFlags usage, const char* name) {
    return {device,
            {.name = name, .format = format, .extent = extent, .usage = usage, .samples = samples}};
}

}  // namespace

MultisamplePlan planMultisample(std::uint32_t deviceSamples, std::uint32_t side) {
    if (deviceSamples < 4 || (side != 4 && side != 8)) return {};
    return {
        .samples = 4, .pixels = side / 4, .shifts = {{0, 0}, {0.25f, 0}, {0.5f, 0}, {0.75f, 0}}};
}

CaptureMs::Scratch::Scratch(const gpu::Device& device, std::uint32_t width, std::uint32_t rows,
                            std::uint32_t s)
    : Scratch(device, checkedPlan(device, s), {width, rows}, s) {}

CaptureMs::Scratch::Scratch(const gpu::Device& device, const MultisamplePlan& plan,
                            vk::Extent2D band, std::uint32_t s)
    : color(target(device, {band.width * plan.pixels + 1, band.height * plan.pixels + 1},
                   vk::Format::eR8G8B8A8Unorm, plan.samples,
                   Usage::eColorAttachment | Usage::eSampled, "capture: multisamples")),
      depth(target(device, color.extent(), vk::Format::eD32Sfloat, plan.samples,
                   Usage::eDepthStencilAttachment, "capture: multisample depth")),
      ids(target(device, {band.width * s, band.height * s}, vk::Format::eR32Uint, 1,
                 Usage::eStorage | Usage::eSampled | Usage::eTransferSrc, "capture: samples")) {}

CaptureMs::CaptureMs(const gpu::Device& device, const scene::SceneFeatures& features,
                     std::uint32_t s)
    : side(s),
      plan(checkedPlan(device, s)),
      sampler(makeTextureSampler(device)),
      pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      gather(device, "gather samples", kGatherCode, {Slot::sampledImage, Slot::storageImage},
             sizeof(shared::CaptureMsParams), {side / plan.pixels, plan.samples}) {
    for (std::size_t bin = 0; bin < scene::kDrawBins; ++bin)
        pipelines.push_back(
            makePipeline(device, features, side / plan.pixels, plan.samples, DrawBin(bin)));
}

void CaptureMs::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                       const geometry::DrawList& list, const glm::mat4& clipFromWorld,
                       vk::Extent2D base, const Band& band, const Scratch& scratch) const {
    const auto pass = rec.pass("capture");
    const auto bindings = scene::withScene(
        scene, {list.ids, scene.materials, {scene.textureViews(), sampler}, scene.secondUvs});
    const glm::vec2 size(base.width * plan.pixels, base.height * plan.pixels), wide = size + 2.0f;
    const auto firstRow = static_cast<float>(band.firstRow * plan.pixels);
    for (const glm::vec2 shift : plan.shifts) {
        rec.beginRendering({.colors = {scratch.color}, .depth = scratch.depth});
        // A pixel more on each side, in whole pixels: some drivers cut off what a viewport with a
        // fraction covers of its last pixels. The shift is in the matrix.
        rec.vk().setViewport(
            0, vk::Viewport{.y = -firstRow, .width = wide.x, .height = wide.y, .maxDepth = 1});
        glm::mat4 shifted(1);
        shifted[0][0] = size.x / wide.x;
        shifted[1][1] = size.y / wide.y;
        shifted[3] = glm::vec4(-2.0f * shift / wide, 0, 1);
        for (std::uint32_t bin = 0; bin < scene::kDrawBins; ++bin) {
            if (scene.binStarts()[bin] == scene.binStarts()[bin + 1]) continue;
            rec.drawIndirect(pipelines[bin], list.draws, bin * sizeof(vk::DrawIndirectCommand),
                             bindings,
                             shared::CaptureMsDrawParams{shifted * clipFromWorld, wide, firstRow});
        }
        rec.endRendering();
        rec.barrier(Stage::raster, Stage::compute);
        rec.dispatch(gather, gpu::groups8x8(scratch.color.extent()),
                     {{scratch.color, pointSampler}, scratch.ids},
                     shared::CaptureMsParams{shift, {base.width * side, band.rows * side}});
        rec.barrier(Stage::compute, Stage::raster);
    }
    rec.barrier(Stage::compute, Stage::compute);
}

}  // namespace lodestar::visibility

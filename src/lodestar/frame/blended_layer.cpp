// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/blended_layer.hpp>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/visibility/peel_params.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/frame/targets.hpp>

namespace lodestar::frame {
namespace {

using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

std::vector<gpu::View> views(const std::vector<gpu::Image>& images) {
    return {images.begin(), images.end()};
}

}  // namespace

BlendedLayer::BlendedLayer(const gpu::Device& owner, const scene::GpuScene& scene,
                           vk::Extent2D room)
    : device(&owner),
      peel(owner, scene.features()),
      layer(owner),
      list(owner, scene, "layer", scene::TablePart::light),
      peeled(owner, room),
      targets(owner, room),
      coverageImage(target(owner, room, vk::Format::eR32Sfloat, "layer: coverage",
                           Usage::eStorage | Usage::eTransferDst)) {
    makeRoom(std::max(room.width * room.height / 8, 4096u));
}

void BlendedLayer::makeRoom(std::uint32_t capacity) {
    fragments.emplace(*device, capacity);
    const vk::Extent2D extent = fragments->ids.extent();
    surfaces.emplace(*device, extent);
    const auto image = [&](const char* name) {
        return target(*device, extent, vk::Format::eR16G16B16A16Sfloat, name, Usage::eStorage);
    };
    terms.emplace(image("layer: terms"));
    radiance.emplace(image("layer: radiance"));
}

/// How many of the fragments found at `size` there would be at the largest.
std::uint32_t BlendedLayer::mostOf(vk::Extent2D size) const {
    const auto area = [](vk::Extent2D e) { return std::uint64_t{e.width} * e.height; };
    const std::uint64_t most = area(coverageImage.extent());
    const std::uint64_t scaledUp = fragments->found() * most / area(size);
    return static_cast<std::uint32_t>(std::min(scaledUp, most * shared::LS_PEELS));
}

gpu::FrameTimes BlendedLayer::blend(gpu::Recorder& rec, const scene::GpuScene& scene,
                                    const geometry::Cull& cull, const Shading& with,
                                    const Over& over) {
    const auto& view = *with.view.mapped<shared::ViewParams>();
    const vk::Extent2D size = scaled(over.radiance.extent, over.scale);
    rec.barrier(Stage::raster, Stage::compute);  // the table's part was the light maps'
    rec.barrier(Stage::compute, Stage::compute);
    cull.record(rec, scene,
                {.clipFromWorld = view.clipFromWorld,
                 .eye = view.eye,
                 .size = size,
                 .shown = over.shown,
                 .lod = over.lod},
                list);
    rec.barrier(Stage::compute, Stage::raster);
    rec.barrier(Stage::compute, Stage::indirect);
    peel.record(rec, scene, {list, view.clipFromWorld, over.depth, size, over.textureScale},
                peeled);

    const shading::Layer::Peeled found{views(peeled.ids), views(peeled.alphas), over.depth, size};
    layer.recordList(rec, found, *fragments, targets);
    gpu::FrameTimes times = rec.submit();
    rec.begin();
    if (const std::uint32_t most = mostOf(size); most > fragments->capacity) {
        // Rare: once more, where there is room for them at every scale.
        makeRoom(most + most / 4);
        layer.recordList(rec, found, *fragments, targets);
        gpu::FrameTimes again = rec.submit();
        again.precede(times);
        times = again;
        rec.begin();
    }
    if (fragments->found() == 0) {
        rec.vk().clearColorImage(
            coverageImage.view().image, vk::ImageLayout::eGeneral, vk::ClearColorValue(),
            vk::ImageSubresourceRange{
                .aspectMask = vk::ImageAspectFlagBits::eColor, .levelCount = 1, .layerCount = 1});
        rec.barrier(Stage::transfer, Stage::compute);
        return times;
    }
    shade(rec, scene, with, over, size);
    layer.recordBlend(rec, found, *radiance, targets, over.radiance,
                      part(coverageImage, over.radiance.extent));
    return times;
}

void BlendedLayer::shade(gpu::Recorder& rec, const scene::GpuScene& scene, const Shading& with,
                         const Over& over, vk::Extent2D size) {
    const vk::Extent2D extent = fragments->extent();
    const gpu::View ids = part(fragments->ids, extent), points = part(fragments->points, extent);
    with.rebuild.record(rec, scene, {ids, with.view, points, size, over.textureScale}, *surfaces);
    with.coarse.recordFull(
        rec, scene,
        {ids, with.lightMaps.sunMap(), with.lightMaps.skyMaps(), with.view, with.light, points},
        shared::LS_ALL_TERMS, part(*terms, extent));
    rec.barrier(Stage::compute, Stage::compute);
    with.combine.record(rec,
                        {with.view, with.light, surfaces->depth, surfaces->material,
                         surfaces->emissive, *terms, with.sky, scene.lights, points},
                        part(*radiance, extent));
    rec.barrier(Stage::compute, Stage::compute);
}

}  // namespace lodestar::frame

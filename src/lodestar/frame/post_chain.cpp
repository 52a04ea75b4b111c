// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/post_chain.hpp>

#include <cmath>

#include <lodestar/frame/targets.hpp>
#include <lodestar/post/effective.hpp>

namespace lodestar::frame {
namespace {

using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

constexpr std::uint32_t kOcclusionChannel = 8;  // w of the terms

vk::Extent2D half(vk::Extent2D size) {
    return {(size.width + 1) / 2, (size.height + 1) / 2};
}

PostSettings chosen(const PostSettings& settings, const scene::GpuScene& scene) {
    PostSettings s = settings;
    if (s.occlusion.radius == 0) s.occlusion.radius = std::max(scene.bounds().radius() / 40, 1e-6f);
    return s;
}

/// Texels of O along an axis that one of B covers.
std::uint32_t sideOf(std::uint32_t rate) {
    switch (rate) {
        case 1:
            return 1;
        case 4:
            return 2;
        case 16:
            return 4;
        case 64:
            return 8;
        default:
            throw std::invalid_argument("Levers::postRates must be 1, 4, 16 or 64");
    }
}

/// A grid B whose texels are `side` pixels wide and high.
shared::EffectiveGrid evenGrid(vk::Extent2D full, float side) {
    const auto along = [&](std::uint32_t n) {
        return static_cast<std::uint32_t>(std::ceil(static_cast<float>(n) / side));
    };
    return post::effectiveGrid({along(full.width), along(full.height)}, full, glm::vec2(side));
}

}  // namespace

PostChain::PostChain(const gpu::Device& owner, const scene::GpuScene& scene, const PostSettings& s,
                     const upsample::Sigmas& sigma, vk::Extent2D most)
    : device(&owner),
      settings(chosen(s, scene)),
      sigmas(sigma),
      room(most),
      inputs(makeInputs(owner, s, most)) {}

vk::Extent2D PostChain::roomOf(std::uint32_t side) const {
    return {(room.width + side - 1) / side, (room.height + side - 1) / side};
}

PostChain::Inputs PostChain::makeInputs(const gpu::Device& device, const PostSettings& s,
                                        vk::Extent2D room) {
    const vk::Extent2D most = half(room);
    Inputs made{.sampleGrid = visibility::SampleGrid(device),
                .rebuild = {device, scene::SceneFeatures{}, true},
                .ids = target(device, most, vk::Format::eR32Uint, "grid B: ids", Usage::eStorage),
                .points = target(device, most, vk::Format::eR32G32Sfloat, "grid B: points",
                                 Usage::eStorage),
                .surfaces = visibility::Surface::guides(device, most)};
    if (s.downsampled) made.maxDepth.emplace(device, room);
    return made;
}

bool PostChain::fromRecord(const PostPicture& p) const {
    return p.record && !settings.downsampled &&
           2 * p.record->base.width <= p.ids.extent.width + 1 &&
           2 * p.record->base.height <= p.ids.extent.height + 1;
}

PostChain::Guides PostChain::gridOf(const PostPicture& p, std::uint32_t rate) const {
    const vk::Extent2D full = p.ids.extent;
    const float side = static_cast<float>(sideOf(rate)) * p.supersample;
    if (side == 1)
        return {post::effectiveGrid(full, full, glm::vec2(1)), part(p.surfaces.depth, full),
                part(p.surfaces.normal, full)};
    shared::EffectiveGrid grid = evenGrid(full, side);
    if (fromRecord(p)) {
        const vk::Extent2D base = p.record->base;
        const glm::vec2 perTexel =
            glm::vec2(full.width, full.height) / glm::vec2(base.width, base.height);
        grid = post::effectiveGrid(base, full, perTexel);
    }
    const vk::Extent2D size{grid.size.x, grid.size.y};
    return {grid, part(inputs.surfaces.depth, size), part(inputs.surfaces.normal, size)};
}

PostChain::Guides PostChain::recordGuides(gpu::Recorder& rec, const PostPicture& p,
                                          std::uint32_t rate) {
    const Guides made = gridOf(p, rate);
    const vk::Extent2D full = p.ids.extent, size = made.size();
    if (size == full) return made;
    const float side = made.grid.rate.x;
    if (settings.downsampled) {
        const auto times = static_cast<std::uint32_t>(std::lround(std::log2(side)));
        inputs.maxDepth->record(rec, {part(p.surfaces.depth, full), part(p.surfaces.normal, full)},
                                times, {made.depth, made.normal});
        rec.barrier(Stage::compute, Stage::compute);
        return made;
    }
    const gpu::View ids = part(inputs.ids, size), points = part(inputs.points, size);
    const bool records = fromRecord(p);
    if (records)
        p.expand->recordRepresentatives(rec, p.scene, *p.record, ids);
    else
        inputs.sampleGrid.record(rec, p.ids, side, {ids, points});
    rec.barrier(Stage::compute, Stage::compute);
    inputs.rebuild.record(rec, p.scene,
                          {.ids = ids,
                           .view = p.view,
                           .points = records ? std::nullopt : std::optional(points),
                           .grid = size,
                           .pass = "grid B"},
                          inputs.surfaces);
    rec.barrier(Stage::compute, Stage::compute);
    return made;
}

PostChain::Occlusion PostChain::makeOcclusion(vk::Extent2D extent) const {
    const auto packed = [&](const char* name) {
        return target(*device, extent, vk::Format::eR32G32B32A32Uint, name, Usage::eStorage);
    };
    return {post::Ssao(*device),
            upsample::Upsample(*device, settings.bilateral ? upsample::Reconstruct::bilateral
                                                           : upsample::Reconstruct::bilinear),
            packed("ssao: turns"), packed("ssao")};
}

void PostChain::recordOcclusion(gpu::Recorder& rec, const PostPicture& p,
                                const budget::Levers& levers, gpu::View terms) {
    if (!settings.ssao) return;
    const std::uint32_t rate = levers.postRate(budget::Effect::ssao), side = sideOf(rate);
    if (!occlusion || occlusion->side > side)
        occlusion.emplace(Sized<Occlusion>{side, makeOcclusion(roomOf(side))});
    const Occlusion& made = occlusion->pass;
    rec.barrier(Stage::compute, Stage::compute);
    const Guides guides = recordGuides(rec, p, rate);
    made.pass.record(rec, {p.view, guides.depth, guides.normal, guides.grid}, settings.occlusion,
                     made.scratch, made.result);
    rec.barrier(Stage::compute, Stage::compute);
    made.upsample.record(rec,
                         {made.result, part(p.surfaces.depth, p.ids.extent), p.surfaces.normal,
                          guides.size(), std::max(guides.grid.rate.x, 1.0f)},
                         sigmas, terms, {.channels = kOcclusionChannel});
    rec.barrier(Stage::compute, Stage::compute);
}

void PostChain::recordLens(gpu::Recorder& rec, const PostPicture& p, const budget::Levers& levers,
                           gpu::View radiance) {
    if (settings.dof) recordDof(rec, p, levers.postRate(budget::Effect::dof), radiance);
    if (settings.shutter == 0 || !motion) return;
    const std::uint32_t rate = levers.postRate(budget::Effect::motionBlur), side = sideOf(rate);
    if (!motionBlur || motionBlur->side > side)
        motionBlur.emplace(Sized<post::MotionBlur>{side, post::MotionBlur(*device, roomOf(side))});
    rec.barrier(Stage::compute, Stage::compute);
    const float pixels = static_cast<float>(side) * p.supersample;
    motionBlur->pass.record(rec,
                            {part(p.surfaces.depth, p.ids.extent), *motion,
                             evenGrid(p.ids.extent, pixels), settings.bilateral},
                            settings.shutter, radiance);
    rec.barrier(Stage::compute, Stage::compute);
}

void PostChain::recordDof(gpu::Recorder& rec, const PostPicture& p, std::uint32_t rate,
                          gpu::View radiance) {
    const std::uint32_t side = sideOf(rate);
    if (!dof || dof->side > side)
        dof.emplace(Sized<post::Dof>{
            side, post::Dof(*device, roomOf(side),
                            settings.downsampled ? std::optional(room) : std::nullopt)});
    rec.barrier(Stage::compute, Stage::compute);
    post::DofOptions options = *settings.dof;
    if (options.focus == 0) options.focus = p.focus;
    if (options.full == 0) {
        options.sharp = 0.05f * options.focus;
        options.full = 0.6f * options.focus;
    }
    dof->pass.record(rec,
                     {part(p.surfaces.depth, p.ids.extent), gridOf(p, rate).grid,
                      settings.bilateral, p.pixelAspect},
                     options, radiance);
    rec.barrier(Stage::compute, Stage::compute);
}

}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>

#include <algorithm>
#include <cmath>

#include <glm/gtc/packing.hpp>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/shading/light_params.h>
#include <lodestar/upsample/upsample_params.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/post/exposure.hpp>

namespace lodestar::frame {
namespace {

using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

gpu::Image target(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                  const char* name, vk::ImageUsageFlags extra = {}) {
    return {device,
            {.name = name,
             .format = format,
             .extent = extent,
             .usage = Usage::eSampled | Usage::eTransferSrc | extra}};
}

gpu::Image makeSkyImage(const gpu::Device& device, const shading::Sky& sky) {
    constexpr auto kSize = static_cast<std::uint32_t>(shading::SkyMap::kSize);
    gpu::Image image(device, {.name = "sky",
                              .format = vk::Format::eR16G16B16A16Sfloat,
                              .extent = {kSize, kSize},
                              .usage = Usage::eSampled | Usage::eTransferDst,
                              .levels = shading::SkyMap::kLevels});
    const shading::SkyMap map = shading::makeSkyMap(sky);
    for (std::uint32_t level = 0; level < map.levels.size(); ++level) {
        std::vector<std::uint64_t> halves;
        for (const glm::vec4& texel : map.levels[level]) halves.push_back(glm::packHalf4x16(texel));
        gpu::uploadImage(device, image, level, std::as_bytes(std::span(halves)));
    }
    return image;
}

/// The sun: the scene's first directional light, or that of the settings.
const scene::Light* sunOf(const scene::Scene& scene) {
    for (const scene::Light& light : scene.lights)
        if (light.kind == scene::LightKind::directional) return &light;
    return nullptr;
}

glm::vec3 sunDirection(const scene::GpuScene& scene, const FrameSettings& settings) {
    if (const scene::Light* light = sunOf(scene.scene()))
        return glm::normalize(glm::vec3(scene.nodeTransforms()[light->node][2]));
    return glm::normalize(settings.toSun);
}

/// Terms that share a grid S.
struct RateGroup {
    float rate;
    shading::Coarse::Mask terms;
};

/// By rate, the coarsest first.
std::vector<RateGroup> rateGroups(const budget::Levers& levers) {
    std::vector<RateGroup> groups;
    for (std::size_t i = 0; i < budget::kTerms; ++i) {
        const float rate = levers.rate(budget::Term(i));
        const shading::Coarse::Mask bit = 1u << i;
        const auto same = std::find_if(groups.begin(), groups.end(), [&](const RateGroup& group) {
            return std::abs(group.rate - rate) < 1e-3f;
        });
        if (same != groups.end())
            same->terms |= bit;
        else
            groups.push_back({rate, bit});
    }
    std::sort(groups.begin(), groups.end(),
              [](const RateGroup& a, const RateGroup& b) { return a.rate > b.rate; });
    return groups;
}

float luminance(glm::vec3 color) {
    return glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

/// Light maps outlive the view they were first drawn for, so their levels of detail go by their own
/// texels: off by no more than half of one, which is within the bias that hides a map's own steps.
geometry::LodChoice lightLods(const geometry::LodChoice& eye) {
    using Mode = geometry::LodChoice::Mode;
    return {.mode = eye.mode == Mode::off ? Mode::off : Mode::error, .errorPx = 0.5f};
}

const FrameSettings& checked(const FrameSettings& s) {
    if (s.size.width < 1 || s.size.height < 1 || s.size.width > 16384 || s.size.height > 16384)
        throw std::invalid_argument("FrameSettings::size must be 1 … 16384 pixels a side");
    if (s.shadowTaps > 32) throw std::invalid_argument("FrameSettings::shadowTaps must be ≤ 32");
    if (s.shadowMapSize < 16 || s.shadowMapSize > 16384)
        throw std::invalid_argument("FrameSettings::shadowMapSize must be 16 … 16384");
    if (s.noiseOctaves > 12)
        throw std::invalid_argument("FrameSettings::noiseOctaves must be ≤ 12");
    if (!(s.noiseScale >= 0)) throw std::invalid_argument("FrameSettings::noiseScale must be ≥ 0");
    if (!(s.exposure >= 0) || std::isinf(s.exposure))
        throw std::invalid_argument("FrameSettings::exposure must be ≥ 0");
    if (s.skyViews > shared::LS_MAX_SKY_VIEWS)
        throw std::invalid_argument("FrameSettings::skyViews must be ≤ 16");
    if (s.captureSide != 1 && s.captureSide != 2 && s.captureSide != 4 && s.captureSide != 8)
        throw std::invalid_argument("FrameSettings::captureSide must be 1, 2, 4 or 8");
    if (std::max(s.size.width, s.size.height) > 16384 / s.captureSide)
        throw std::invalid_argument("FrameSettings::size must be ≤ 16384 / captureSide");
    if (s.captureSide > 1 && s.showLods)
        throw std::invalid_argument("FrameSettings::showLods needs captureSide 1");
    if (s.skyTaps < 1 || s.skyTaps > 32)
        throw std::invalid_argument("FrameSettings::skyTaps must be 1 … 32");
    if (s.skyMapSize < 16 || s.skyMapSize > 4096)
        throw std::invalid_argument("FrameSettings::skyMapSize must be 16 … 4096");
    return s;
}

}  // namespace

Frame::Frame(const gpu::Device& owner, const scene::GpuScene& gpuScene, const FrameSettings& s)
    : device(&owner),
      scene(&gpuScene),
      options(checked(s)),
      sky(sunDirection(gpuScene, s)),
      irradiance(sky.irradiance()),
      aspect(s.aspect > 0 ? s.aspect
                          : static_cast<float>(s.size.width) / static_cast<float>(s.size.height)),
      cull(owner),
      showLods(owner),
      capture(owner, gpuScene.features()),
      rebuildPass(owner, gpuScene.features()),
      coarse(owner),
      upsample(owner, s.reconstruct),
      repairSelect(owner),
      combine(owner, gpuScene.features()),
      tonemap(owner),
      eyeList(owner, gpuScene, "eye"),
      hiz(owner, s.size, "hi-z"),
      lightMaps(owner, gpuScene, sky,
                {.sunTexels = s.shadowMapSize,
                 .skyTexels = s.skyMapSize,
                 .skyViews = s.skyViews,
                 .shadows = s.shadowTaps > 0,
                 .shadowDistance = s.shadowDistance,
                 .lod = lightLods(s.lod)}),
      repairList(owner, s.size),
      viewBuffer(owner, "view", sizeof(shared::ViewParams), gpu::Residence::mapped),
      lightBuffer(owner, "light", sizeof(shared::LightParams), gpu::Residence::mapped),
      idImage(target(owner, s.size, vk::Format::eR32Uint, "ids",
                     Usage::eColorAttachment | Usage::eStorage)),
      depthBuffer(target(owner, s.size, vk::Format::eD32Sfloat, "depth buffer",
                         Usage::eDepthStencilAttachment)),
      skyImage(makeSkyImage(owner, sky)),
      coarseImage(target(owner, s.size, vk::Format::eR32G32B32A32Uint, "coarse", Usage::eStorage)),
      termImage(target(owner, s.size, vk::Format::eR16G16B16A16Sfloat, "terms", Usage::eStorage)),
      radianceImage(target(owner, s.size, vk::Format::eR16G16B16A16Sfloat, "radiance",
                           Usage::eStorage | Usage::eTransferDst)),
      displayImage(target(owner, s.size, vk::Format::eR8G8B8A8Unorm, "display", Usage::eStorage)),
      surfaces(owner, s.size),
      rec(owner) {
    // A sun of the file has the colour it says. Its strength sets what a lux is: the sky is as
    // bright beside it as beside the real sun, lamps and emissive surfaces as the file has them.
    sunIlluminance = sky.sunIlluminance();
    if (const scene::Light* light = sunOf(gpuScene.scene())) {
        const float lux = luminance(light->color) * light->intensity;
        perLux = lux > 0 ? shading::Sky::kSunIlluminance / lux : 1;
        sunIlluminance = light->color * (light->intensity * perLux);
    }
}

gpu::FrameTimes Frame::render(const scene::Camera& camera, const budget::Levers& levers) {
    if (options.captureSide > 1) return renderSamples(camera);
    if (options.exposure == 0) {
        options.exposure = 1;
        render(camera, {});
        meter();
    }
    rec.begin();
    lightMaps.update(rec, *scene, cull, camera, aspect);
    writeUniforms(camera);

    // Which triangle does each pixel show?
    findVisible({.clipFromWorld = clipFromWorld(camera),
                 .eye = camera.eye,
                 .size = options.size,
                 .cull = options.cull,
                 .lod = options.lod});

    shade(levers);
    if (options.showLods) {
        rec.barrier(Stage::compute, Stage::compute);
        showLods.record(rec, *scene, idImage, displayImage);
    }
    return rec.submit();
}

/// Captured, compacted and rebuilt in one go.
gpu::FrameTimes Frame::renderSamples(const scene::Camera& camera) {
    if (!samples) {
        CaptureSettings settings{
            .base = options.size, .side = options.captureSide, .backend = options.capture};
        if (options.capture == CaptureBackend::automatic)
            settings.backend = chooseBackend(*device, *scene, settings, camera);
        samples.emplace(*device, *scene, settings);
    }
    const gpu::FrameTimes captured = samples->capture(camera).times;
    gpu::FrameTimes times = rebuildAntialiased(samples->compact(), camera);
    times.gpuMs += captured.gpuMs;
    times.wallMs += captured.wallMs;
    times.passes.insert(times.passes.begin(), captured.passes.begin(), captured.passes.end());
    return times;
}

gpu::FrameTimes Frame::renderOutside(const scene::Camera& outside) {
    if (samples) throw std::logic_error("Frame::renderOutside needs captureSide 1");
    rec.begin();
    lightMaps.update(rec, *scene, cull, outside, aspect);
    writeUniforms(outside);
    rec.barrier(Stage::compute, Stage::raster);
    capture.record(rec, *scene, eyeList, clipFromWorld(outside), {idImage, depthBuffer}, "capture");
    rec.barrier(Stage::raster, Stage::compute);
    hiz.reset();  // the depth buffer shows another view now
    shade({});
    if (options.showLods) {
        rec.barrier(Stage::compute, Stage::compute);
        showLods.record(rec, *scene, idImage, displayImage);
    }
    return rec.submit();
}

gpu::FrameTimes Frame::rebuild(const visibility::CompactRecord& from, const scene::Camera& camera,
                               const budget::Levers& levers) {
    if (options.exposure == 0) {
        options.exposure = 1;
        rebuild(from, camera, {});
        meter();
    }
    if (!rebuilding || rebuilding->side != from.side)
        rebuilding = Rebuilding{from.side, {*device, from.side}};
    rec.begin();
    lightMaps.update(rec, *scene, cull, camera, aspect);
    writeUniforms(camera);
    rebuilding->expand.record(rec, *scene, from, clipFromWorld(camera), idImage);
    rec.barrier(Stage::compute, Stage::compute);
    shade(levers);
    return rec.submit();
}

void Frame::shade(const budget::Levers& levers) {
    if (levers.resizeAll && levers.shadingRate > 1) {
        shadeOnGridS(levers.shadingRate);
        rec.barrier(Stage::compute, Stage::compute);
        tonemap.record(rec, radianceImage, options.exposure, displayImage);
        return;
    }
    // What is exact on grid O, and the expensive terms on grids S.
    rebuildPass.record(rec, *scene, {idImage, viewBuffer}, surfaces);
    evaluateTerms(levers);
    rec.barrier(Stage::compute, Stage::compute);

    combine.record(rec,
                   {viewBuffer, lightBuffer, surfaces.depth, surfaces.material, surfaces.emissive,
                    termImage, skyImage, scene->lights},
                   radianceImage);
    rec.barrier(Stage::compute, Stage::compute);
    tonemap.record(rec, radianceImage, options.exposure, displayImage);
}

Frame::Whole Frame::makeWhole() const {
    const auto image = [&](vk::Format format, const char* name) {
        return target(*device, options.size, format, name, Usage::eStorage);
    };
    return {.sampleGrid = visibility::SampleGrid(*device),
            .guides = {*device, scene::SceneFeatures{}},
            .pack = upsample::PackCoarse(*device),
            .ids = image(vk::Format::eR32Uint, "grid S: ids"),
            .points = image(vk::Format::eR32G32Sfloat, "grid S: points"),
            .terms = image(vk::Format::eR16G16B16A16Sfloat, "grid S: terms"),
            .radiance = image(vk::Format::eR16G16B16A16Sfloat, "grid S: radiance"),
            .surfaces = {*device, options.size}};
}

/// Everything on grid S, reconstructed as one colour: what the paper calls full resizing.
void Frame::shadeOnGridS(float rate) {
    if (!whole) whole.emplace(makeWhole());
    listHolds = false;
    const vk::Extent2D size = shading::coarseExtent(options.size, rate);
    const auto part = [&](const gpu::Image& image) {
        gpu::View view = image;
        view.extent = size;
        return view;
    };
    const gpu::View ids = part(whole->ids), points = part(whole->points);
    whole->sampleGrid.record(rec, idImage, rate, {ids, points});
    rec.barrier(Stage::compute, Stage::compute);
    rebuildPass.record(rec, *scene, {ids, viewBuffer, points, size}, whole->surfaces);
    coarse.recordFull(
        rec, *scene,
        {ids, lightMaps.sunMap(), lightMaps.skyMaps(), viewBuffer, lightBuffer, points},
        shared::LS_ALL_TERMS, part(whole->terms));
    rec.barrier(Stage::compute, Stage::compute);
    const visibility::Surface& surface = whole->surfaces;
    combine.record(rec,
                   {viewBuffer, lightBuffer, surface.depth, surface.material, surface.emissive,
                    whole->terms, skyImage, scene->lights, points},
                   part(whole->radiance));
    // Conventional resizing has no guides and needs no depth and normal of O.
    const bool guided = upsample.guided();
    if (guided) whole->guides.record(rec, *scene, {idImage, viewBuffer}, surfaces);
    rec.barrier(Stage::compute, Stage::compute);
    whole->pack.record(rec, {part(whole->radiance), surface.depth, surface.normal}, coarseImage);
    rec.barrier(Stage::compute, Stage::compute);
    upsample.record(rec, {coarseImage, surfaces.depth, surfaces.normal, size, rate}, options.sigmas,
                    radianceImage);
}

glm::mat4 Frame::clipFromWorld(const scene::Camera& camera) const {
    return camera.clipFromView(aspect) * camera.viewFromWorld();
}

Frame::Smooth Frame::makeSmooth(std::uint32_t side, std::uint32_t capacity) const {
    visibility::FragmentSet set(*device, options.size, capacity);
    const vk::Extent2D more = set.moreIds.extent();
    const auto radiance = [&](vk::Extent2D extent, const char* name) {
        return target(*device, extent, vk::Format::eR16G16B16A16Sfloat, name, Usage::eStorage);
    };
    return {.side = side,
            .fragments = {*device, side},
            .set = std::move(set),
            .surfaces = {*device, more},
            .terms = radiance(more, "fragments: terms"),
            .radiance = radiance(more, "fragments: radiance"),
            .mainRadiance = radiance(options.size, "fragments: main radiance")};
}

gpu::FrameTimes Frame::rebuildAntialiased(const visibility::CompactRecord& from,
                                          const scene::Camera& camera) {
    if (from.base != options.size)
        throw std::invalid_argument("Frame::rebuildAntialiased: the record has another size");
    if (options.exposure == 0) {
        options.exposure = 1;
        rebuildAntialiased(from, camera);
        meter();
    }
    if (!smooth || smooth->side != from.side)
        smooth.emplace(makeSmooth(from.side, options.size.width * options.size.height / 16 + 1));
    listHolds = false;
    const visibility::Fragments& fragments = smooth->fragments;
    const visibility::FragmentSet& set = smooth->set;
    const gpu::Image& mainRadiance = smooth->mainRadiance;
    const auto shadeAt = [&](const gpu::View& ids, const gpu::View& points,
                             const visibility::Surface& surface, const gpu::View& terms,
                             const gpu::View& radiance) {
        rebuildPass.record(rec, *scene, {ids, viewBuffer, points, options.size}, surface);
        coarse.recordFull(
            rec, *scene,
            {ids, lightMaps.sunMap(), lightMaps.skyMaps(), viewBuffer, lightBuffer, points},
            shared::LS_ALL_TERMS, terms);
        rec.barrier(Stage::compute, Stage::compute);
        combine.record(rec,
                       {viewBuffer, lightBuffer, surface.depth, surface.material, surface.emissive,
                        terms, skyImage, scene->lights, points},
                       radiance);
        rec.barrier(Stage::compute, Stage::compute);
    };
    // A fragment a pixel, and from them most of what else the pixels list.
    rec.begin();
    lightMaps.update(rec, *scene, cull, camera, aspect);
    writeUniforms(camera);
    fragments.record(rec, from, set);
    rec.barrier(Stage::compute, Stage::compute);
    shadeAt(set.ids, set.points, surfaces, termImage, mainRadiance);
    fragments.recordMerge(rec, *scene, from,
                          {viewBuffer, surfaces.depth, surfaces.normal, mainRadiance}, set,
                          radianceImage);
    const gpu::FrameTimes first = rec.submit();
    if (set.overflowed()) {
        // Rare enough to begin again, in a set that has room.
        const std::uint32_t needed = set.found().further;
        smooth.emplace(makeSmooth(from.side, needed + needed / 4));
        return rebuildAntialiased(from, camera);
    }

    // The few that are left.
    const auto part = [&](const gpu::Image& image) {
        gpu::View view = image;
        view.extent = set.moreExtent();
        return view;
    };
    rec.begin();
    if (set.found().further > 0) {
        shadeAt(part(set.moreIds), part(set.morePoints), smooth->surfaces, part(smooth->terms),
                part(smooth->radiance));
        fragments.recordResolve(rec, part(smooth->radiance), set, radianceImage);
        rec.barrier(Stage::compute, Stage::compute);
    }
    tonemap.record(rec, radianceImage, options.exposure, displayImage);
    gpu::FrameTimes times = rec.submit();
    times.gpuMs += first.gpuMs;
    times.wallMs += first.wallMs;
    times.passes.insert(times.passes.begin(), first.passes.begin(), first.passes.end());
    return times;
}

/// Culls and captures; what is hidden, in two phases: first what the last picture does not hide,
/// then what that, drawn, does not hide of the rest. The next frame starts from the whole picture:
/// after a cut the first phase draws next to nothing, and what that hides is next to nothing too.
void Frame::findVisible(const geometry::CullView& view) {
    using Phase = visibility::CaptureSs::Phase;
    const visibility::CaptureSs::Target target{idImage, depthBuffer};
    const auto draw = [&](const char* name, Phase phase) {
        rec.barrier(Stage::compute, Stage::raster);
        rec.barrier(Stage::compute, Stage::indirect);
        capture.record(rec, *scene, eyeList, view.clipFromWorld, target, name, phase);
        rec.barrier(Stage::raster, Stage::compute);
    };
    if (view.cull != geometry::CullMode::hiz) {
        cull.record(rec, *scene, view, eyeList);
        draw("capture", Phase::both);
        return;
    }
    cull.recordFirst(rec, *scene, view, eyeList, hiz);
    draw("capture", Phase::first);
    hiz.record(rec, depthBuffer, view.clipFromWorld);
    cull.recordSecond(rec, *scene, eyeList, hiz);
    draw("capture rest", Phase::second);
    hiz.record(rec, depthBuffer, view.clipFromWorld);
}

void Frame::evaluateTerms(const budget::Levers& levers) {
    const shading::Coarse::Inputs inputs{idImage, lightMaps.sunMap(), lightMaps.skyMaps(),
                                         viewBuffer, lightBuffer};
    const bool repairing = levers.repair > 0;
    if (repairing) upsample::RepairSelect::clear(rec, repairList);
    shading::Coarse::Mask written = 0, toRepair = 0;
    for (const RateGroup& group : rateGroups(levers)) {
        // The first group fills the image, the others replace their channels.
        const auto mask = written == 0 ? shading::Coarse::Mask(shared::LS_ALL_TERMS) : group.terms;
        if (written != 0) rec.barrier(Stage::compute, Stage::compute);
        written |= group.terms;
        if (group.rate == 1) {
            coarse.recordFull(rec, *scene, inputs, mask, termImage);
            continue;
        }
        // The coarsest grid misses most: it says which pixels are repaired, for all the terms.
        const bool lists = repairing && toRepair == 0;
        toRepair |= group.terms;
        coarse.record(rec, *scene, inputs, group.terms, group.rate, coarseImage);
        rec.barrier(Stage::compute, Stage::compute);
        upsample.record(rec,
                        {coarseImage, surfaces.depth, surfaces.normal,
                         shading::coarseExtent(options.size, group.rate), group.rate},
                        options.sigmas, termImage,
                        {.channels = mask,
                         .repair = lists ? &repairList : nullptr,
                         .leastWeight = options.leastWeight});
    }
    listHolds = repairing && toRepair != 0;
    if (!listHolds) return;
    rec.barrier(Stage::compute, Stage::compute);
    repairSelect.record(rec, repairList, levers.repair);
    coarse.recordRepair(rec, *scene, inputs, toRepair, repairList, termImage);
}

std::uint32_t Frame::repairedPixels() const {
    if (!listHolds) return 0;
    return gpu::as<shared::RepairHeader>(
               gpu::readBuffer(*device, repairList.header, sizeof(shared::RepairHeader)))
        .front()
        .kept;
}

void Frame::meter() {
    std::vector<glm::vec4> texels;
    for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(*device, radianceImage)))
        texels.push_back(glm::unpackHalf4x16(bits));
    options.exposure = post::meteredExposure(texels);
}

void Frame::writeUniforms(const scene::Camera& camera) {
    const glm::mat4 clipFromView = camera.clipFromView(aspect);
    *viewBuffer.mapped<shared::ViewParams>() = {
        .clipFromWorld = clipFromView * camera.viewFromWorld(),
        .viewFromWorld = camera.viewFromWorld(),
        .eye = camera.eye,
        .clipScale = {clipFromView[0][0], clipFromView[1][1]}};

    const float cell =
        options.noiseScale > 0 ? options.noiseScale : std::max(scene->bounds().radius() / 8, 1e-6f);
    shared::LightParams light{.toSun = sky.toSun(),
                              .sunIlluminance = sunIlluminance,
                              .shadowTaps = options.shadowTaps,
                              .skyViewCount = options.skyViews,
                              .skyTaps = options.skyTaps,
                              .noiseOctaves = options.noiseOctaves,
                              .noiseFrequency = 1 / cell,
                              .lightCount = scene->lightCount(),
                              .skyLevels = shading::SkyMap::kLevels,
                              .exposure = options.exposure,
                              .perLux = perLux};
    std::copy(irradiance.begin(), irradiance.end(), light.irradiance);
    light.views[0] = lightMaps.sun().params();
    std::transform(lightMaps.sky().begin(), lightMaps.sky().end(), light.views + 1,
                   [](const shading::LightView& view) { return view.params(); });
    *lightBuffer.mapped<shared::LightParams>() = light;
}

}  // namespace lodestar::frame

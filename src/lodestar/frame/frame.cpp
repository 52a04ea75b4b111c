// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>

#include <algorithm>
#include <cmath>

#include <glm/gtc/packing.hpp>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/shading/light_params.h>
#include <lodestar/upsample/refine_params.h>
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
std::vector<RateGroup> rateGroups(const budget::Levers& levers, float supersample) {
    std::vector<RateGroup> groups;
    for (std::size_t i = 0; i < budget::kTerms; ++i) {
        const float rate = levers.rate(budget::Term(i)) * supersample;
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

constexpr float kLeastScale = 0.5f, kMostScale = 2;

/// `size` at a render scale, at least a pixel and at most what a target can be.
vk::Extent2D scaled(vk::Extent2D size, float scale) {
    const auto along = [&](std::uint32_t n) {
        return std::clamp(static_cast<std::uint32_t>(std::lround(static_cast<float>(n) * scale)),
                          1u, 16384u);
    };
    return {along(size.width), along(size.height)};
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
    if (!(s.maxScale >= kLeastScale && s.maxScale <= kMostScale))
        throw std::invalid_argument("FrameSettings::maxScale must be 0.5 … 2");
    if (s.shadowTaps > 64) throw std::invalid_argument("FrameSettings::shadowTaps must be ≤ 64");
    if (s.shadowMapSize < 16 || s.shadowMapSize > 16384)
        throw std::invalid_argument("FrameSettings::shadowMapSize must be 16 … 16384");
    if (s.noiseOctaves > 12)
        throw std::invalid_argument("FrameSettings::noiseOctaves must be ≤ 12");
    if (s.noiseWarps > 8) throw std::invalid_argument("FrameSettings::noiseWarps must be ≤ 8");
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
    if (s.supersample < 1 || s.supersample > 4 ||
        std::max(s.size.width, s.size.height) * s.supersample > 16384)
        throw std::invalid_argument(
            "FrameSettings::supersample must be 1 … 4, and O ≤ 16384 a side");
    if (s.supersample > 1 && s.showLods)
        throw std::invalid_argument("FrameSettings::showLods: not with supersample");
    if (s.captureSide > 1 && (s.supersample > 1 || s.maxScale > 1 || s.motion ||
                              s.temporal.mode != scale::TemporalMode::off))
        throw std::invalid_argument(
            "FrameSettings::captureSide: not with supersample, maxScale, motion or temporal");
    if (s.supersample > 1 && s.temporal.mode != scale::TemporalMode::off)
        throw std::invalid_argument("FrameSettings::temporal: not with supersample");
    return s;
}

FrameSettings supersampled(FrameSettings s) {
    s.size.width *= s.supersample;
    s.size.height *= s.supersample;
    return s;
}

}  // namespace

Frame::Frame(const gpu::Device& owner, const scene::GpuScene& gpuScene, const FrameSettings& s)
    : Frame(owner, gpuScene, supersampled(checked(s)), s.size) {
    if (s.supersample > 1)
        reduction.emplace(
            Reduction{post::Reduce(owner), target(owner, s.size, vk::Format::eR16G16B16A16Sfloat,
                                                  "reduced radiance", Usage::eStorage)});
}

Frame::Frame(const gpu::Device& owner, const scene::GpuScene& gpuScene, const FrameSettings& s,
             vk::Extent2D shown)
    : device(&owner),
      scene(&gpuScene),
      options(s),
      room(scaled(s.size, std::max(s.maxScale, 1.0f))),
      live(s.size),
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
      refine(owner),
      repairSelect(owner),
      combine(owner, gpuScene.features()),
      tonemap(owner),
      spatial(owner),
      eyeList(owner, gpuScene, "eye"),
      hiz(owner, s.size, "hi-z"),
      lightMaps(owner, gpuScene, sky,
                {.sunTexels = s.shadowMapSize,
                 .skyTexels = s.skyMapSize,
                 .skyViews = s.skyViews,
                 .shadows = s.shadowTaps > 0,
                 .shadowDistance = s.shadowDistance,
                 .lod = lightLods(s.lod)}),
      repairList(owner, room),
      refineList(owner, room),
      viewBuffer(owner, "view", sizeof(shared::ViewParams), gpu::Residence::mapped),
      lightBuffer(owner, "light", sizeof(shared::LightParams), gpu::Residence::mapped),
      idImage(target(owner, room, vk::Format::eR32Uint, "ids",
                     Usage::eColorAttachment | Usage::eStorage)),
      depthBuffer(target(owner, room, vk::Format::eD32Sfloat, "depth buffer",
                         Usage::eDepthStencilAttachment)),
      skyImage(makeSkyImage(owner, sky)),
      coarseImage(target(owner, room, vk::Format::eR32G32B32A32Uint, "coarse", Usage::eStorage)),
      termImage(target(owner, room, vk::Format::eR16G16B16A16Sfloat, "terms", Usage::eStorage)),
      radianceImage(target(owner, room, vk::Format::eR16G16B16A16Sfloat, "radiance",
                           Usage::eStorage | Usage::eTransferDst)),
      shownImage(target(owner, room, vk::Format::eR8G8B8A8Unorm, "shown", Usage::eStorage)),
      displayImage(target(owner, shown, vk::Format::eR8G8B8A8Unorm, "display", Usage::eStorage)),
      surfaces(owner, room),
      rec(owner) {
    const bool joins = s.temporal.mode != scale::TemporalMode::off;
    if (s.motion || joins) tracker.emplace(owner, gpuScene, room);
    if (joins) temporal.emplace(owner, room, s.size, s.temporal);
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
        reset();
    }
    if ((levers.renderScale != 1 || options.maxScale > 1) && (reduction || levers.localRate > 0))
        throw std::invalid_argument("Levers::renderScale: not with supersample or a local rate");
    if (temporal && levers.resizeAll)
        throw std::invalid_argument("Levers::resizeAll leaves nothing to join pictures by");
    begin(camera, levers.renderScale, options.temporal.mode);

    // Which triangle does each pixel show?
    findVisible({.clipFromWorld = clipFromWorld(camera),
                 .eye = camera.eye,
                 .size = live,
                 .cull = options.cull,
                 .lod = options.lod});

    if (tracker) tracker->record(rec, *scene, ids(), viewBuffer, steadyClipFromWorld(camera));
    shade(levers);
    if (options.showLods) {
        rec.barrier(Stage::compute, Stage::compute);
        showLods.record(rec, *scene, ids(), displayImage);
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
    begin(outside, 1, scale::TemporalMode::off);
    rec.barrier(Stage::compute, Stage::raster);
    capture.record(rec, *scene, eyeList, clipFromWorld(outside), {ids(), part(depthBuffer, live)},
                   "capture");
    rec.barrier(Stage::raster, Stage::compute);
    reset();  // the targets show another view now
    shade({});
    if (options.showLods) {
        rec.barrier(Stage::compute, Stage::compute);
        showLods.record(rec, *scene, ids(), displayImage);
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
    begin(camera, levers.renderScale, scale::TemporalMode::off);
    rebuilding->expand.record(rec, *scene, from, clipFromWorld(camera), ids());
    rec.barrier(Stage::compute, Stage::compute);
    if (tracker) tracker->record(rec, *scene, ids(), viewBuffer, steadyClipFromWorld(camera));
    shade(levers);
    return rec.submit();
}

void Frame::begin(const scene::Camera& camera, float renderScale, scale::TemporalMode mode) {
    if (!(renderScale >= kLeastScale && renderScale <= std::max(options.maxScale, 1.0f)))
        throw std::invalid_argument("Levers::renderScale must be 0.5 … FrameSettings::maxScale");
    live = scaled(options.size, renderScale);
    repairList.size = live;
    joining = mode;
    const glm::vec2 grid(live.width, live.height);
    jitter = 2.0f * scale::jitterOf(mode, pictures++, renderScale) / grid;
    textureScale = scale::textureScaleOf(mode, renderScale);
    rec.begin();
    lightMaps.update(rec, *scene, cull, camera, aspect);
    writeUniforms(camera);
}

void Frame::shade(const budget::Levers& levers) {
    if (levers.resizeAll && levers.shadingRate > 1) {
        shadeOnGridS(levers.shadingRate * static_cast<float>(options.supersample));
        show();
        return;
    }
    // What is exact on grid O, and the expensive terms on grids S.
    rebuildPass.record(rec, *scene, {ids(), viewBuffer, {}, live, textureScale}, surfaces);
    evaluateTerms(levers);
    rec.barrier(Stage::compute, Stage::compute);

    combine.record(rec,
                   {viewBuffer, lightBuffer, surfaces.depth, surfaces.material, surfaces.emissive,
                    termImage, skyImage, scene->lights},
                   radiance());
    show();
}

/// From the radiance on grid O to the picture.
void Frame::show() {
    rec.barrier(Stage::compute, Stage::compute);
    if (reduction) {
        reduction->pass.record(rec, radianceImage, options.reduce, reduction->radiance);
        rec.barrier(Stage::compute, Stage::compute);
        tonemap.record(rec, reduction->radiance, options.exposure, displayImage);
        return;
    }
    const bool joins = joining != scale::TemporalMode::off;
    if (live == options.size && !joins) {
        tonemap.record(rec, radianceImage, options.exposure, displayImage);
        return;
    }
    tonemap.record(rec, radianceImage, options.exposure, part(shownImage, live));
    rec.barrier(Stage::compute, Stage::compute);
    if (!joins) {
        spatial.record(rec, shownImage, live, options.scaling, displayImage);
        return;
    }
    temporal->record(rec,
                     {.color = shownImage,
                      .motion = tracker->motion(),
                      .depth = surfaces.depth,
                      .terms = termImage,
                      .material = surfaces.material,
                      .live = live,
                      .jitter = jitter * glm::vec2(live.width, live.height) * 0.5f,
                      .moved = tracker->moved()},
                     displayImage);
}

Frame::Whole Frame::makeWhole() const {
    const auto image = [&](vk::Format format, const char* name) {
        return target(*device, room, format, name, Usage::eStorage);
    };
    return {.sampleGrid = visibility::SampleGrid(*device),
            .guides = {*device, scene::SceneFeatures{}, true},
            .pack = upsample::PackCoarse(*device, options.packing),
            .ids = image(vk::Format::eR32Uint, "grid S: ids"),
            .points = image(vk::Format::eR32G32Sfloat, "grid S: points"),
            .terms = image(vk::Format::eR16G16B16A16Sfloat, "grid S: terms"),
            .radiance = image(vk::Format::eR16G16B16A16Sfloat, "grid S: radiance"),
            .surfaces = {*device, room}};
}

/// Everything on grid S, reconstructed as one colour: what the paper calls full resizing.
void Frame::shadeOnGridS(float rate) {
    if (!whole) whole.emplace(makeWhole());
    listHolds = refines = false;
    const vk::Extent2D size = shading::coarseExtent(live, rate);
    const auto onS = [&](const gpu::Image& image) { return part(image, size); };
    const gpu::View ids = onS(whole->ids), points = onS(whole->points);
    whole->sampleGrid.record(rec, this->ids(), rate, {ids, points});
    rec.barrier(Stage::compute, Stage::compute);
    rebuildPass.record(rec, *scene, {ids, viewBuffer, points, size}, whole->surfaces);
    coarse.recordFull(
        rec, *scene,
        {ids, lightMaps.sunMap(), lightMaps.skyMaps(), viewBuffer, lightBuffer, points},
        shared::LS_ALL_TERMS, onS(whole->terms));
    rec.barrier(Stage::compute, Stage::compute);
    const visibility::Surface& surface = whole->surfaces;
    combine.record(rec,
                   {viewBuffer, lightBuffer, surface.depth, surface.material, surface.emissive,
                    whole->terms, skyImage, scene->lights, points},
                   onS(whole->radiance));
    // Conventional resizing has no guides and needs no depth and normal of O.
    const bool guided = upsample.guided();
    if (guided) whole->guides.record(rec, *scene, {this->ids(), viewBuffer}, surfaces);
    rec.barrier(Stage::compute, Stage::compute);
    whole->pack.record(rec, {onS(whole->radiance), surface.depth, surface.normal}, coarseImage);
    rec.barrier(Stage::compute, Stage::compute);
    upsample.record(rec, {coarseImage, depth(), surfaces.normal, size, rate}, options.sigmas,
                    radiance());
}

void Frame::reset() {
    hiz.reset();
    if (tracker) tracker->reset();
    if (temporal) temporal->reset();
}

glm::mat4 Frame::steadyClipFromWorld(const scene::Camera& camera) const {
    return camera.clipFromView(aspect) * camera.viewFromWorld();
}

glm::mat4 Frame::clipFromWorld(const scene::Camera& camera) const {
    glm::mat4 clip = steadyClipFromWorld(camera);
    for (int i = 0; i < 4; ++i) {
        clip[i].x += jitter.x * clip[i].w;
        clip[i].y += jitter.y * clip[i].w;
    }
    return clip;
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
    listHolds = refines = false;
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
    begin(camera, 1, scale::TemporalMode::off);
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
    const auto more = [&](const gpu::Image& image) { return part(image, set.moreExtent()); };
    rec.begin();
    if (set.found().further > 0) {
        shadeAt(more(set.moreIds), more(set.morePoints), smooth->surfaces, more(smooth->terms),
                more(smooth->radiance));
        fragments.recordResolve(rec, more(smooth->radiance), set, radianceImage);
        rec.barrier(Stage::compute, Stage::compute);
    }
    show();
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
    const visibility::CaptureSs::Target target{ids(), part(depthBuffer, live)};
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
    hiz.record(rec, part(depthBuffer, live), view.clipFromWorld);
    cull.recordSecond(rec, *scene, eyeList, hiz);
    draw("capture rest", Phase::second);
    hiz.record(rec, part(depthBuffer, live), view.clipFromWorld);
}

void Frame::evaluateTerms(const budget::Levers& levers) {
    const shading::Coarse::Inputs inputs{.ids = ids(),
                                         .sunMap = lightMaps.sunMap(),
                                         .skyMaps = lightMaps.skyMaps(),
                                         .view = viewBuffer,
                                         .light = lightBuffer,
                                         .packing = options.packing};
    const bool repairing = levers.repair > 0;
    refines = false;
    if (repairing) upsample::RepairSelect::clear(rec, repairList);
    shading::Coarse::Mask written = 0, toRepair = 0;
    for (const RateGroup& group : rateGroups(levers, static_cast<float>(options.supersample))) {
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
        evaluateOnGridS(inputs, group.terms, group.rate, levers.localRate);
        rec.barrier(Stage::compute, Stage::compute);
        upsample.record(rec,
                        {coarseImage, depth(), surfaces.normal,
                         shading::coarseExtent(live, group.rate), group.rate},
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

/// Every texel of S, or with a local rate every second one and, where the terms vary, the others.
void Frame::evaluateOnGridS(const shading::Coarse::Inputs& inputs, shading::Coarse::Mask terms,
                            float rate, float localRate) {
    coarse.record(rec, *scene, inputs, terms, rate, coarseImage, localRate > 0 ? 2 : 1);
    if (localRate == 0) return;
    refines = true;
    rec.barrier(Stage::compute, Stage::compute);
    refine.record(rec, {surfaces.depth, surfaces.normal, shading::coarseExtent(live, rate), rate},
                  options.sigmas, localRate, coarseImage, refineList);
    coarse.recordListed(rec, *scene, inputs, terms, rate, refineList, coarseImage);
}

void Frame::setShadowTaps(std::uint32_t taps) {
    if (taps < 1 || taps > 64) throw std::invalid_argument("Frame::setShadowTaps: 1 … 64");
    if (options.shadowTaps > 0) options.shadowTaps = taps;
}

std::uint32_t Frame::refinedTexels() const {
    if (!refines) return 0;
    return gpu::as<shared::RefineHeader>(
               gpu::readBuffer(*device, refineList.header, sizeof(shared::RefineHeader)))
        .front()
        .listed;
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
    for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(*device, radiance())))
        texels.push_back(glm::unpackHalf4x16(bits));
    options.exposure = post::meteredExposure(texels);
}

void Frame::writeUniforms(const scene::Camera& camera) {
    const glm::mat4 clipFromView = camera.clipFromView(aspect);
    *viewBuffer.mapped<shared::ViewParams>() = {
        .clipFromWorld = clipFromWorld(camera),
        .viewFromWorld = camera.viewFromWorld(),
        .eye = camera.eye,
        .clipScale = {clipFromView[0][0], clipFromView[1][1]},
        .jitter = jitter};

    const float cell =
        options.noiseScale > 0 ? options.noiseScale : std::max(scene->bounds().radius() / 8, 1e-6f);
    shared::LightParams light{.toSun = sky.toSun(),
                              .sunIlluminance = sunIlluminance,
                              .shadowTaps = options.shadowTaps,
                              .skyViewCount = options.skyViews,
                              .skyTaps = options.skyTaps,
                              .noiseOctaves = options.noiseOctaves,
                              .noiseWarps = options.noiseWarps,
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

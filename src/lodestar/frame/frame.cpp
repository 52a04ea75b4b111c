// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <glm/gtc/packing.hpp>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/shading/light_params.h>
#include <lodestar/frame/post_chain.hpp>
#include <lodestar/frame/targets.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/post/exposure.hpp>

namespace lodestar::frame {
namespace {

using gpu::Stage;

void check(const budget::Levers& levers) {
    if (!(levers.layerScale >= 0.25f && levers.layerScale <= 1))
        throw std::invalid_argument("Levers::layerScale must be 0.25 … 1");
}

}  // namespace

gpu::FrameTimes Frame::render(const scene::Camera& camera, const budget::Levers& levers) {
    if (options.captureSide > 1) return renderSamples(camera, levers);
    if (options.exposure == 0) {
        options.exposure = 1;
        render(camera, {});
        meter();
        reset();
    }
    if ((levers.renderScale != 1 || options.maxScale.largest() > 1) &&
        (reduction || levers.localRate > 0))
        throw std::invalid_argument("Levers::renderScale: not with supersample or a local rate");
    check(levers);
    if (temporal && levers.resizeAll)
        throw std::invalid_argument("Levers::resizeAll leaves nothing to join pictures by");
    begin(camera, levers, options.temporal.mode);

    // Which triangle does each pixel show?
    findVisible({.clipFromWorld = clipFromWorld(camera),
                 .eye = camera.eye,
                 .size = live,
                 .shown = countedIn(),
                 .cull = options.cull,
                 .lod = options.lod,
                 .wavePx = options.wavePx,
                 .samples = capture.samplesOf(clipFromWorld(camera), live)});

    if (tracker) tracker->record(rec, *scene, ids(), viewBuffer, steadyClipFromWorld(camera));
    if (tracker && post) post->moved(motion());
    shade(levers);
    if (options.showLods) {
        rec.barrier(Stage::compute, Stage::compute);
        showLods.record(rec, *scene, ids(), displayImage);
    }
    return finish();
}

gpu::FrameTimes Frame::renderOutside(const scene::Camera& outside) {
    if (samples) throw std::logic_error("Frame::renderOutside needs captureSide 1");
    begin(outside, {}, scale::TemporalMode::off);
    capture.record(rec, *scene, eyeList, clipFromWorld(outside), ids(), "capture",
                   geometry::DrawPhase::both, textureScale);
    reset();  // the targets show another view now
    shade({});
    if (options.showLods) {
        rec.barrier(Stage::compute, Stage::compute);
        showLods.record(rec, *scene, ids(), displayImage);
    }
    return finish();
}

gpu::FrameTimes Frame::rebuild(const visibility::CompactRecord& from, const scene::Camera& camera,
                               const budget::Levers& levers) {
    if (options.exposure == 0) {
        options.exposure = 1;
        rebuild(from, camera, {});
        meter();
    }
    check(levers);
    if (!rebuilding || rebuilding->side != from.side)
        rebuilding = Rebuilding{from.side, {*device, from.side}};
    begin(camera, levers, scale::TemporalMode::off);
    rebuilding->expand.record(rec, *scene, from, clipFromWorld(camera), ids());
    rec.barrier(Stage::compute, Stage::compute);
    if (tracker) tracker->record(rec, *scene, ids(), viewBuffer, steadyClipFromWorld(camera));
    if (tracker && post) post->moved(motion());
    shade(levers, &from);
    return finish();
}

void Frame::begin(const scene::Camera& camera, const budget::Levers& levers,
                  scale::TemporalMode mode) {
    const budget::AxisScale renderScale = levers.renderScale;
    if (!isRenderScale(renderScale, options.maxScale.atLeast(1)))
        throw std::invalid_argument("Levers::renderScale must be 0.5 … FrameSettings::maxScale");
    if (!(levers.shadowScale >= 0.25f && levers.shadowScale <= 1))
        throw std::invalid_argument("Levers::shadowScale must be 0.25 … 1");
    live = scaled(options.size, renderScale);
    repairList.size = live;
    joining = mode;
    const glm::vec2 grid(live.width, live.height);
    jitter = 2.0f * scale::jitterOf(mode, pictures++) / grid;
    textureScale = scale::textureScaleOf(mode, renderScale);
    submitted = {};
    focus = std::max(glm::distance(camera.eye, camera.at), 1e-6f);
    if (post) post->moved(std::nullopt);
    rec.begin();
    lightMaps.update(rec, *scene, cull, camera, aspect, levers.shadowScale);
    writeUniforms(camera);
}

void Frame::shade(const budget::Levers& levers, const visibility::CompactRecord* from) {
    if (post && levers.resizeAll)
        throw std::invalid_argument("Levers::resizeAll: not with FrameSettings::post");
    if (levers.resizeAll && levers.shadingRate > 1) {
        shadeOnGridS(levers.shadingRate * static_cast<float>(options.supersample));
        blendLayer(levers.layerScale);
        show();
        return;
    }
    shadeBackground(keepsTerms() && !termsAreConstant());
    // What is exact on grid O, and the expensive terms on grids S.
    rebuildPass.record(rec, *scene,
                       {.ids = ids(),
                        .view = viewBuffer,
                        .grid = live,
                        .textureScale = textureScale,
                        .tiles = &coveredTiles},
                       surfaces);
    const std::optional<upsample::Upsample::Inputs> termsOnS = evaluateTerms(levers);
    if (post) post->recordOcclusion(rec, picture(from), levers, terms());
    rec.barrier(Stage::compute, Stage::compute);

    if (termsOnS)
        combineFromS(*termsOnS, levers.repair);
    else
        combine.record(rec, combineInputs(), radiance());
    blendLayer(levers.layerScale);
    if (post) post->recordLens(rec, picture(from), levers, radiance());
    show();
}

shading::Combine::Inputs Frame::combineInputs() const {
    return {.view = viewBuffer,
            .light = lightBuffer,
            .depth = surfaces.depth,
            .material = surfaces.material,
            .emissive = surfaces.emissive,
            .terms = termImage,
            .sky = skyImage,
            .lights = scene->lights,
            .tiles = &coveredTiles};
}

void Frame::blendLayer(float scale) {
    if (!layer) return;
    rec.barrier(Stage::compute, Stage::compute);
    submitted.precede(
        layer->blend(rec, *scene, cull,
                     {rebuildPass, coarse, combine, lightMaps, viewBuffer, lightBuffer, skyImage},
                     {depth(), radiance(), scale, textureScale, options.lod, countedIn()}));
}

gpu::FrameTimes Frame::finish() {
    gpu::FrameTimes times = rec.submit();
    times.precede(submitted);
    return times;
}

PostPicture Frame::picture(const visibility::CompactRecord* from) const {
    return {
        .scene = *scene,
        .view = viewBuffer,
        .ids = ids(),
        .surfaces = surfaces,
        .record = from,
        .expand = rebuilding ? &rebuilding->expand : nullptr,
        .focus = focus,
        .pixelAspect = aspect * static_cast<float>(live.height) / static_cast<float>(live.width),
        .supersample = static_cast<float>(options.supersample)};
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
                      .layer = layer ? &layer->coverage() : nullptr,
                      .live = live,
                      .jitter = jitter * glm::vec2(live.width, live.height) * 0.5f,
                      .moved = tracker->moved()},
                     displayImage);
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
    if (guided) shadeBackground(false);
    if (guided || layer)
        whole->guides.record(
            rec, *scene,
            {.ids = this->ids(), .view = viewBuffer, .tiles = guided ? &coveredTiles : nullptr},
            surfaces);
    rec.barrier(Stage::compute, Stage::compute);
    whole->pack.record(rec, {onS(whole->radiance), surface.depth, surface.normal}, coarseImage);
    rec.barrier(Stage::compute, Stage::compute);
    upsample.record(
        rec, {coarseImage, depth(), surfaces.normal, size, rate, guided ? &coveredTiles : nullptr},
        options.sigmas, radiance());
}

/// Finds the tiles of O that show something, and is done with the others.
void Frame::shadeBackground(bool writesTerms) {
    shading::Background::Outputs out{.depth = depth(), .radiance = radiance()};
    if (writesTerms) out.terms = terms();
    listTiles.record(rec, ids(), coveredTiles, emptyTiles);
    background.record(rec, {viewBuffer, lightBuffer, skyImage, emptyTiles}, out);
    rec.barrier(Stage::compute, Stage::compute);
}

void Frame::reset() {
    hiz.reset();
    if (tracker) tracker->reset();
    if (temporal) temporal->reset();
}

/// Joined pictures show what one of the output's size would, whatever their own: another level of
/// detail at every change of S would be seen as noise.
std::optional<vk::Extent2D> Frame::countedIn() const {
    if (joining == scale::TemporalMode::off) return {};
    return options.size;
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

/// Culls and captures; what is hidden, in two phases: first what the last picture does not hide,
/// then what that, drawn, does not hide of the rest. The next frame starts from the whole picture:
/// after a cut the first phase draws next to nothing, and what that hides is next to nothing too.
void Frame::findVisible(const geometry::CullView& view) {
    using Phase = geometry::DrawPhase;
    const auto draw = [&](const char* name, Phase phase) {
        const bool complete = phase == Phase::second || view.cull != geometry::CullMode::hiz;
        capture.record(rec, *scene, eyeList, view.clipFromWorld, ids(), name, phase, textureScale,
                       complete);
    };
    tessellate.record(rec, *scene, view);
    if (view.cull != geometry::CullMode::hiz) {
        cull.record(rec, *scene, view, eyeList);
        draw("capture", Phase::first);
        return;
    }
    cull.recordFirst(rec, *scene, view, eyeList, hiz);
    draw("capture", Phase::first);
    capture.recordHiZ(rec, live, view.clipFromWorld, hiz);
    cull.recordSecond(rec, *scene, eyeList, hiz);
    draw("capture rest", Phase::second);
    capture.recordHiZ(rec, live, view.clipFromWorld, hiz);
}

void Frame::setShadowTaps(std::uint32_t taps) {
    if (taps < 1 || taps > shared::LS_MAX_SHADOW_TAPS)
        throw std::invalid_argument("Frame::setShadowTaps: 1 … 128");
    if (options.shadowTaps > 0) options.shadowTaps = taps;
}

float Frame::refinementCoarsened() const {
    return options.wavePx > 0 && !samples ? tessellate.coarsenedBy() : 1;
}

void Frame::meter() {
    std::vector<glm::vec4> texels;
    for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(*device, radiance())))
        texels.push_back(glm::unpackHalf4x16(bits));
    options.exposure = post::meteredExposure(texels);
}

}  // namespace lodestar::frame

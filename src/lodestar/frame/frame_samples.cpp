// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>

#include <stdexcept>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/frame/post_chain.hpp>
#include <lodestar/frame/targets.hpp>

// Several samples a pixel: captured, compacted, and blended by what each surface covers.

namespace lodestar::frame {

using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

// A pixel's samples together are a box of its size; the tents that mip-mapping blends are wider.
// With gradients this much smaller a texture looks most as 64 shaded samples a pixel show it.
constexpr glm::vec2 kTextureScale{0.6f};

/// Captured, compacted and rebuilt in one go.
gpu::FrameTimes Frame::renderSamples(const scene::Camera& camera, const budget::Levers& levers) {
    if (!samples) {
        CaptureSettings settings{.base = options.size,
                                 .side = options.captureSide,
                                 .backend = options.capture,
                                 .lod = options.lod};
        if (options.capture == CaptureBackend::automatic)
            settings.backend = chooseBackend(*device, *scene, settings, camera);
        samples.emplace(*device, *scene, settings);
    }
    const gpu::FrameTimes captured = samples->capture(camera).times;
    gpu::FrameTimes times = rebuildAntialiased(samples->compact(), camera, levers);
    times.gpuMs += captured.gpuMs;
    times.wallMs += captured.wallMs;
    times.passes.insert(times.passes.begin(), captured.passes.begin(), captured.passes.end());
    return times;
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
                                          const scene::Camera& camera,
                                          const budget::Levers& levers) {
    if (from.base != options.size)
        throw std::invalid_argument("Frame::rebuildAntialiased: the record has another size");
    if (options.exposure == 0) {
        options.exposure = 1;
        rebuildAntialiased(from, camera, levers);
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
        rebuildPass.record(rec, *scene, {ids, viewBuffer, points, options.size, kTextureScale},
                           surface);
        coarse.recordFull(
            rec, *scene,
            {ids, lightMaps.sunMap(), lightMaps.skyMaps(), viewBuffer, lightBuffer, points},
            shared::LS_ALL_TERMS, terms);
        // What the screen shows occludes the fragments that it shows.
        if (post && terms.image == termImage.view().image) {
            PostPicture shown = picture(nullptr);
            shown.ids = ids;
            post->recordOcclusion(rec, shown, levers, terms);
        }
        rec.barrier(Stage::compute, Stage::compute);
        combine.record(rec,
                       {viewBuffer, lightBuffer, surface.depth, surface.material, surface.emissive,
                        terms, skyImage, scene->lights, points},
                       radiance);
        rec.barrier(Stage::compute, Stage::compute);
    };
    // A fragment a pixel, and from them most of what else the pixels list.
    begin(camera, {.shadowScale = levers.shadowScale}, scale::TemporalMode::off);
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
        return rebuildAntialiased(from, camera, levers);
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
    submitted = first;
    blendLayer(1);
    if (post) {
        PostPicture shown = picture(nullptr);
        shown.ids = part(set.ids, live);
        post->recordLens(rec, shown, levers, radiance());
    }
    show();
    return finish();
}

}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>

#include <glm/gtc/packing.hpp>

#include <lodestar/shading/light_params.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/gpu/readback.hpp>

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

/// The scene's first directional light, or the sun of the settings.
glm::vec3 sunDirection(const scene::GpuScene& scene, const FrameSettings& settings) {
    for (const scene::Light& light : scene.scene().lights)
        if (light.kind == scene::LightKind::directional)
            return glm::normalize(glm::vec3(scene.nodeTransforms()[light.node][2]));
    return glm::normalize(settings.toSun);
}

const FrameSettings& checked(const FrameSettings& s) {
    if (s.size.width < 1 || s.size.height < 1 || s.size.width > 16384 || s.size.height > 16384)
        throw std::invalid_argument("FrameSettings::size must be 1 … 16384 pixels a side");
    if (s.shadowTaps > 32) throw std::invalid_argument("FrameSettings::shadowTaps must be ≤ 32");
    if (s.shadowMapSize < 16 || s.shadowMapSize > 16384)
        throw std::invalid_argument("FrameSettings::shadowMapSize must be 16 … 16384");
    return s;
}

}  // namespace

Frame::Frame(const gpu::Device& owner, const scene::GpuScene& gpuScene, const FrameSettings& s)
    : device(&owner),
      scene(&gpuScene),
      options(checked(s)),
      sky(sunDirection(gpuScene, s)),
      aspect(s.aspect > 0 ? s.aspect
                          : static_cast<float>(s.size.width) / static_cast<float>(s.size.height)),
      cull(owner),
      capture(owner, gpuScene.features()),
      shadowCapture(owner, gpuScene.features(), visibility::CaptureSs::Writes::depthOnly),
      rebuildPass(owner, gpuScene.features()),
      coarse(owner),
      upsample(owner, s.reconstruct),
      combine(owner, gpuScene.features()),
      tonemap(owner),
      eyeList(owner, gpuScene, "eye"),
      sunList(owner, gpuScene, "sun"),
      viewBuffer(owner, "view", sizeof(shared::ViewParams), gpu::Residence::mapped),
      lightBuffer(owner, "light", sizeof(shared::LightParams), gpu::Residence::mapped),
      idImage(target(owner, s.size, vk::Format::eR32Uint, "ids",
                     Usage::eColorAttachment | Usage::eStorage)),
      depthBuffer(target(owner, s.size, vk::Format::eD32Sfloat, "depth buffer",
                         Usage::eDepthStencilAttachment)),
      shadowMap(target(owner, {s.shadowMapSize, s.shadowMapSize}, vk::Format::eD32Sfloat,
                       "shadow map", Usage::eDepthStencilAttachment)),
      skyImage(makeSkyImage(owner, sky)),
      coarseImage(target(owner, s.size, vk::Format::eR32G32B32A32Uint, "coarse", Usage::eStorage)),
      termImage(target(owner, s.size, vk::Format::eR16G16B16A16Sfloat, "terms", Usage::eStorage)),
      radianceImage(
          target(owner, s.size, vk::Format::eR16G16B16A16Sfloat, "radiance", Usage::eStorage)),
      displayImage(target(owner, s.size, vk::Format::eR8G8B8A8Unorm, "display", Usage::eStorage)),
      surfaces(owner, s.size),
      rec(owner) {}

gpu::FrameTimes Frame::render(const scene::Camera& camera, const budget::Levers& levers) {
    rec.begin();
    drawShadowMap(rec, camera);
    writeUniforms(camera);

    // Which triangle does each pixel show?
    cull.record(rec, *scene, {clipFromWorld(camera), camera.eye, options.size}, eyeList);
    rec.barrier(Stage::compute, Stage::raster);
    rec.barrier(Stage::compute, Stage::indirect);
    capture.record(rec, *scene, eyeList, clipFromWorld(camera), {idImage, depthBuffer}, "capture");
    rec.barrier(Stage::raster, Stage::compute);

    shade(levers);
    return rec.submit();
}

gpu::FrameTimes Frame::rebuild(const visibility::CompactRecord& from, const scene::Camera& camera,
                               const budget::Levers& levers) {
    if (!rebuilding || rebuilding->side != from.side)
        rebuilding = Rebuilding{from.side, {*device, from.side}};
    rec.begin();
    drawShadowMap(rec, camera);
    writeUniforms(camera);
    rebuilding->expand.record(rec, *scene, from, clipFromWorld(camera), idImage);
    rec.barrier(Stage::compute, Stage::compute);
    shade(levers);
    return rec.submit();
}

void Frame::shade(const budget::Levers& levers) {
    // The expensive terms on grid S, and what is exact on grid O.
    const shading::Coarse::Inputs coarseInputs{idImage, shadowMap, viewBuffer, lightBuffer};
    rebuildPass.record(rec, *scene, {idImage, viewBuffer}, surfaces);
    if (levers.shadingRate > 1) {
        coarse.record(rec, *scene, coarseInputs, levers.shadingRate, coarseImage);
        rec.barrier(Stage::compute, Stage::compute);
        upsample.record(
            rec,
            {coarseImage, surfaces.depth, surfaces.normal,
             shading::coarseExtent(options.size, levers.shadingRate), levers.shadingRate},
            options.sigmas, termImage);
    } else {
        coarse.recordFull(rec, *scene, coarseInputs, termImage);
    }
    rec.barrier(Stage::compute, Stage::compute);

    combine.record(rec,
                   {viewBuffer, lightBuffer, surfaces.depth, surfaces.material, surfaces.emissive,
                    termImage, skyImage, scene->lights},
                   radianceImage);
    rec.barrier(Stage::compute, Stage::compute);
    tonemap.record(rec, radianceImage, options.exposure, displayImage);
}

glm::mat4 Frame::clipFromWorld(const scene::Camera& camera) const {
    return camera.clipFromView(aspect) * camera.viewFromWorld();
}

Frame::Smooth Frame::makeSmooth(const visibility::CompactRecord& from,
                                std::uint32_t capacity) const {
    visibility::FragmentSet set(*device, from, capacity);
    const vk::Extent2D more = set.moreIds.extent();
    const auto radiance = [&](vk::Extent2D extent, const char* name) {
        return target(*device, extent, vk::Format::eR16G16B16A16Sfloat, name, Usage::eStorage);
    };
    return {.side = from.side,
            .fragments = {*device, from.side},
            .resolve = {*device, from.side},
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
    const std::uint32_t pixels = from.base.width * from.base.height;
    if (!smooth || smooth->side != from.side ||
        smooth->set.merges.bytes() < from.lists.buffer().bytes())
        smooth.emplace(makeSmooth(from, pixels / 4 + 1));
    rec.begin();
    smooth->fragments.recordCount(rec, *scene, from, clipFromWorld(camera), camera.eye,
                                  smooth->set);
    const gpu::FrameTimes counted = rec.submit();
    if (const std::uint32_t needed = smooth->set.needed(); needed > smooth->set.capacity) {
        // Rare enough to count again, in a set that has room.
        smooth.emplace(makeSmooth(from, needed + needed / 4));
        return rebuildAntialiased(from, camera);
    }

    rec.begin();
    drawShadowMap(rec, camera);
    writeUniforms(camera);
    auto& set = smooth->set;
    smooth->fragments.recordWrite(rec, *scene, from, clipFromWorld(camera), camera.eye, set);
    rec.barrier(Stage::compute, Stage::compute);
    const auto shadeAt = [&](const gpu::View& ids, const gpu::View& points,
                             const visibility::Surface& surface, const gpu::View& terms,
                             const gpu::View& radiance) {
        rebuildPass.record(rec, *scene, {ids, viewBuffer, points, options.size}, surface);
        coarse.recordFull(rec, *scene, {ids, shadowMap, viewBuffer, lightBuffer, points}, terms);
        rec.barrier(Stage::compute, Stage::compute);
        combine.record(rec,
                       {viewBuffer, lightBuffer, surface.depth, surface.material, surface.emissive,
                        terms, skyImage, scene->lights, points},
                       radiance);
    };
    shadeAt(set.ids, set.points, surfaces, termImage, smooth->mainRadiance);
    const auto part = [&](const gpu::Image& image) {
        gpu::View view = image;
        view.extent = set.moreExtent();
        return view;
    };
    if (set.needed() > 0)
        shadeAt(part(set.moreIds), part(set.morePoints), smooth->surfaces, part(smooth->terms),
                part(smooth->radiance));
    rec.barrier(Stage::compute, Stage::compute);
    smooth->resolve.record(rec, set, smooth->mainRadiance, smooth->radiance, radianceImage);
    rec.barrier(Stage::compute, Stage::compute);
    tonemap.record(rec, radianceImage, options.exposure, displayImage);
    gpu::FrameTimes times = rec.submit();
    times.gpuMs += counted.gpuMs;
    times.wallMs += counted.wallMs;
    times.passes.insert(times.passes.begin(), counted.passes.begin(), counted.passes.end());
    return times;
}

void Frame::drawShadowMap(gpu::Recorder& r, const scene::Camera& camera) {
    const scene::Bounds& bounds = scene->bounds();
    const float toScene = bounds.empty() ? 1 : glm::distance(camera.eye, bounds.centre());
    // To the far side of the scene, wherever in it the eye is.
    const float distance =
        options.shadowDistance > 0 ? options.shadowDistance : toScene + bounds.radius();
    const shading::SunView now =
        shading::fitSun(sky.toSun(), bounds, camera, aspect, distance, options.shadowMapSize);
    if (options.shadowTaps == 0 || (now == sun && shadowVersion == scene->version())) return;
    sun = now;
    shadowVersion = scene->version();

    cull.record(r, *scene,
                {.clipFromWorld = sun.clipFromWorld,
                 .size = shadowMap.extent(),
                 .perspective = false,
                 .keepBeforeNear = true},
                sunList);
    r.barrier(Stage::compute, Stage::raster);
    r.barrier(Stage::compute, Stage::indirect);
    shadowCapture.record(r, *scene, sunList, sun.clipFromWorld, {{}, shadowMap}, "shadow map");
    r.barrier(Stage::raster, Stage::compute);
}

void Frame::writeUniforms(const scene::Camera& camera) {
    const glm::mat4 clipFromView = camera.clipFromView(aspect);
    *viewBuffer.mapped<shared::ViewParams>() = {
        .clipFromWorld = clipFromView * camera.viewFromWorld(),
        .viewFromWorld = camera.viewFromWorld(),
        .eye = camera.eye,
        .clipScale = {clipFromView[0][0], clipFromView[1][1]}};

    shared::LightParams light{.toSun = sky.toSun(),
                              .sunIlluminance = sky.sunIlluminance(),
                              .shadowFromWorld = sun.shadowFromWorld,
                              .shadowRight = sun.right,
                              .shadowUp = sun.up,
                              .shadowTexel = sun.texel,
                              .shadowDepthScale = sun.depthScale,
                              .shadowTaps = options.shadowTaps,
                              .lightCount = scene->lightCount(),
                              .skyLevels = shading::SkyMap::kLevels,
                              .exposure = options.exposure};
    const auto irradiance = sky.irradiance();
    std::copy(irradiance.begin(), irradiance.end(), light.irradiance);
    light.irradianceSlope[0] = irradiance[3];
    light.irradianceSlope[1] = irradiance[1];
    light.irradianceSlope[2] = irradiance[2];
    *lightBuffer.mapped<shared::LightParams>() = light;
}

}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <glm/gtc/color_space.hpp>
#include <glm/gtc/packing.hpp>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/shading/light_params.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/frame/post_chain.hpp>
#include <lodestar/frame/targets.hpp>
#include <lodestar/gpu/readback.hpp>

// What a frame is made of, and what it tells its shaders.

namespace lodestar::frame {
namespace {

using Usage = vk::ImageUsageFlagBits;

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

float luminance(glm::vec3 color) {
    return glm::dot(color, glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

/// Light maps outlive the view they were first drawn for, so their levels of detail go by their own
/// texels: off by no more than half of one, which is within the bias that hides a map's own steps.
geometry::LodChoice lightLods(const geometry::LodChoice& eye) {
    using Mode = geometry::LodChoice::Mode;
    return {.mode = eye.mode == Mode::off ? Mode::off : Mode::error, .errorPx = 0.5f};
}

shading::Coarse::Mask termsOf(const FrameSettings& s) {
    return (s.shadowTaps > 0 ? shared::LS_TERM_SHADOW : 0) |
           (s.skyViews > 0 ? shared::LS_TERM_AO : 0) |
           (s.noiseOctaves > 0 ? shared::LS_TERM_NOISE : 0);
}

const FrameSettings& checked(const FrameSettings& s) {
    if (s.size.width < 1 || s.size.height < 1 || s.size.width > 16384 || s.size.height > 16384)
        throw std::invalid_argument("FrameSettings::size must be 1 … 16384 pixels a side");
    if (!isRenderScale(s.maxScale, kMostScale))
        throw std::invalid_argument("FrameSettings::maxScale must be 0.5 … 2");
    if (s.shadowTaps > shared::LS_MAX_SHADOW_TAPS)
        throw std::invalid_argument("FrameSettings::shadowTaps must be ≤ 128");
    if (s.shadowMapSize < 16 || s.shadowMapSize > 16384)
        throw std::invalid_argument("FrameSettings::shadowMapSize must be 16 … 16384");
    if (s.noiseOctaves > 12)
        throw std::invalid_argument("FrameSettings::noiseOctaves must be ≤ 12");
    if (s.noiseWarps > 8) throw std::invalid_argument("FrameSettings::noiseWarps must be ≤ 8");
    if (!(s.noiseScale >= 0)) throw std::invalid_argument("FrameSettings::noiseScale must be ≥ 0");
    if (!(s.exposure >= 0) || std::isinf(s.exposure))
        throw std::invalid_argument("FrameSettings::exposure must be ≥ 0");
    if (s.backdrop && !(glm::all(glm::greaterThanEqual(*s.backdrop, glm::vec3(0))) &&
                        glm::all(glm::lessThanEqual(*s.backdrop, glm::vec3(1)))))
        throw std::invalid_argument("FrameSettings::backdrop must be 0 … 1");
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
    if (s.captureSide > 1 && (s.supersample > 1 || s.maxScale.largest() > 1 || s.motion ||
                              s.temporal.mode != scale::TemporalMode::off))
        throw std::invalid_argument(
            "FrameSettings::captureSide: not with supersample, maxScale, motion or temporal");
    if (s.supersample > 1 && s.temporal.mode != scale::TemporalMode::off)
        throw std::invalid_argument("FrameSettings::temporal: not with supersample");
    if (!(s.post.shutter >= 0 && s.post.shutter <= 1))
        throw std::invalid_argument("PostSettings::shutter must be 0 … 1");
    if (s.captureSide > 1 && s.post.shutter > 0)
        throw std::invalid_argument("PostSettings::shutter: not with captureSide over 1");
    if (s.post.downsampled && s.supersample > 1)
        throw std::invalid_argument("PostSettings::downsampled: not with supersample");
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
      room(scaled(s.size, s.maxScale.atLeast(1))),
      live(s.size),
      sky(sunDirection(gpuScene, s)),
      irradiance(sky.irradiance()),
      aspect(s.aspect > 0 ? s.aspect
                          : static_cast<float>(s.size.width) / static_cast<float>(s.size.height)),
      tessellate(owner, gpuScene),
      cull(owner),
      showLods(owner),
      capture(owner, gpuScene, room, s.captureSide > 1 ? CaptureBackend::automatic : s.capture),
      listTiles(owner),
      rebuildPass(owner, gpuScene.features()),
      background(owner, options.backdrop.has_value()),
      coarse(owner, termsOf(s)),
      upsample(owner, s.reconstruct),
      refine(owner),
      repairSelect(owner),
      weighRepair(owner),
      combine(owner, gpuScene.features(), {options.backdrop.has_value(), s.reconstruct}),
      tonemap(owner),
      spatial(owner),
      eyeList(owner, gpuScene, "eye", scene::TablePart::eye,
              capture.backend() == CaptureBackend::compute ? geometry::kProjectedClusters : 0),
      hiz(owner, s.size, "hi-z"),
      lightMaps(owner, gpuScene, sky,
                {.sunTexels = s.shadowMapSize,
                 .skyTexels = s.skyMapSize,
                 .skyViews = s.skyViews,
                 .shadows = s.shadowTaps > 0,
                 .shadowDistance = s.shadowDistance,
                 .lod = lightLods(s.lod)}),
      coveredTiles(owner, room, "covered tiles"),
      emptyTiles(owner, room, "empty tiles"),
      repairList(owner, room),
      termTexels(owner, room, "term texels"),
      viewBuffer(owner, "view", sizeof(shared::ViewParams), gpu::Residence::mapped),
      lightBuffer(owner, "light", sizeof(shared::LightParams), gpu::Residence::mapped),
      idImage(target(owner, room, vk::Format::eR32Uint, "ids",
                     Usage::eColorAttachment | Usage::eStorage)),
      skyImage(makeSkyImage(owner, sky)),
      coarseImage(target(owner, room, vk::Format::eR32G32B32A32Uint, "coarse", Usage::eStorage)),
      termImage(target(owner, room, vk::Format::eR16G16B16A16Sfloat, "terms",
                       Usage::eStorage | Usage::eTransferDst)),
      radianceImage(target(owner, room, vk::Format::eR16G16B16A16Sfloat, "radiance",
                           Usage::eStorage | Usage::eTransferDst)),
      shownImage(target(owner, room, vk::Format::eR8G8B8A8Unorm, "shown", Usage::eStorage)),
      displayImage(target(owner, shown, vk::Format::eR8G8B8A8Unorm, "display", Usage::eStorage)),
      surfaces(owner, room),
      rec(owner) {
    if (gpuScene.features().blended) layer.emplace(owner, gpuScene, room);
    if (s.post.any()) post = std::make_unique<PostChain>(owner, gpuScene, s.post, s.sigmas, room);
    const bool joins = s.temporal.mode != scale::TemporalMode::off;
    if (s.motion || joins || s.post.shutter > 0) tracker.emplace(owner, gpuScene, room);
    if (joins) temporal.emplace(owner, room, s.size, s.temporal);
    if (termsAreConstant()) {
        rec.begin();
        rec.clear(termImage, shared::kTermsOfBackground);
        rec.submit();
    }
    // A sun of the file has the colour it says. Its strength sets what a lux is: the sky is as
    // bright beside it as beside the real sun, lamps and emissive surfaces as the file has them.
    sunIlluminance = sky.sunIlluminance();
    if (const scene::Light* light = sunOf(gpuScene.scene())) {
        const float lux = luminance(light->color) * light->intensity;
        perLux = lux > 0 ? shading::Sky::kSunIlluminance / lux : 1;
        sunIlluminance = light->color * (light->intensity * perLux);
    }
}

Frame::~Frame() = default;

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
    shared::LightParams light{
        .toSun = sky.toSun(),
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
        .perLux = perLux,
        .backdrop = glm::convertSRGBToLinear(options.backdrop.value_or(glm::vec3(0)))};
    std::copy(irradiance.begin(), irradiance.end(), light.irradiance);
    light.views[0] = lightMaps.sun().params();
    std::transform(lightMaps.sky().begin(), lightMaps.sky().end(), light.views + 1,
                   [](const shading::LightView& view) { return view.params(); });
    *lightBuffer.mapped<shared::LightParams>() = light;
}

}  // namespace lodestar::frame

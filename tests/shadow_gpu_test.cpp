// SPDX-License-Identifier: Apache-2.0
// The coarse terms on scenes of a few quads, with shadow maps drawn by the raster pipeline.
#include <cmath>
#include <optional>
#include <random>

#include <glm/gtc/packing.hpp>

#include <lodestar/visibility/view_params.h>
#include <lodestar/geometry/cull.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/shading/coarse.hpp>
#include <lodestar/shading/sky.hpp>
#include <lodestar/visibility/capture_ss.hpp>

#include "gpu_device.hpp"
#include "shadow_scenes.hpp"

namespace lodestar::shading {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::vec3;
using glm::vec4;
using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

scene::Scene sceneOf(const std::vector<Quad>& quads) {
    scene::Scene scene;
    scene.name = "quads";
    scene.materials.push_back({.doubleSided = true});
    scene.nodes.emplace_back();
    for (const Quad& q : quads) {
        scene::Mesh mesh;
        const vec3 normal = glm::normalize(glm::cross(q.alongA, q.alongB));
        for (const glm::dvec2 at : {dvec2(0, 0), dvec2(1, 0), dvec2(1, 1), dvec2(0, 1)}) {
            const vec3 p(q.corner + at.x * q.alongA + at.y * q.alongB);
            mesh.vertices.push_back({.position = p, .normal = normal});
            mesh.bounds.add(p);
        }
        mesh.indices = {0, 1, 2, 0, 2, 3};
        scene.instances.push_back({.mesh = std::uint32_t(scene.meshes.size()), .node = 0});
        scene.meshes.push_back(std::move(mesh));
    }
    return scene;
}

struct Hit {
    dvec3 position, normal;  ///< the normal turned to the eye
    double depth = 0;        ///< linear view depth
    bool nearEdge = false;   ///< so near an edge of some quad that rasterisation decides
};

/// What a pixel of the picture sees, in double precision.
std::optional<Hit> look(const std::vector<Quad>& quads, const scene::Camera& camera, dvec2 ndc,
                        double aspect) {
    const dvec3 forward = glm::normalize(dvec3(camera.at - camera.eye));
    const dvec3 right = glm::normalize(glm::cross(forward, dvec3(camera.up)));
    const dvec3 up = glm::cross(right, forward);
    const double t = std::tan(double(camera.verticalFov) / 2);
    const dvec3 ray = forward + right * (ndc.x * t * aspect) - up * (ndc.y * t);
    std::optional<Hit> best;
    bool nearEdge = false;
    for (const Quad& q : quads) {
        const dvec3 normal = glm::normalize(glm::cross(q.alongA, q.alongB));
        const double d = glm::dot(normal, q.corner - dvec3(camera.eye)) / glm::dot(normal, ray);
        if (!(d > 0)) continue;
        const dvec3 p = dvec3(camera.eye) + d * ray;
        const double a = glm::dot(p - q.corner, q.alongA) / glm::dot(q.alongA, q.alongA);
        const double b = glm::dot(p - q.corner, q.alongB) / glm::dot(q.alongB, q.alongB);
        const double inside = std::min(std::min(a, 1 - a), std::min(b, 1 - b));
        nearEdge = nearEdge || std::abs(inside) < 1e-3;
        if (inside < 0 || (best && best->depth < d)) continue;
        best = Hit{p, glm::dot(normal, ray) > 0 ? -normal : normal, d};
    }
    if (best) best->nearEdge = nearEdge;
    return best;
}

/// The depth maps as drawn, in main memory.
struct DepthMaps {
    int size;
    std::vector<std::vector<float>> maps;  ///< the sun's, then those of the sky

    DepthTexels map(std::size_t i) const { return {maps.at(i), size, size}; }
    double sunVisibility(const shared::LightParams& light, const Hit& hit) const {
        if (light.shadowTaps == 0) return 1;
        return lightVisibilityReference(light.views[0], map(0), int(light.shadowTaps), hit.position,
                                        hit.normal);
    }
    double skyVisibility(const shared::LightParams& light, const Hit& hit) const {
        std::vector<DepthTexels> sky;
        for (std::size_t i = 1; i < maps.size(); ++i) sky.push_back(map(i));
        return skyVisibilityReference(light, sky, hit.position, hit.normal, hit.normal);
    }
};

/// The passes up to the coarse terms, for one scene.
class Rig {
public:
    static constexpr std::uint32_t kMapSize = 128, kSkyViews = 5;

    Rig(const gpu::Device& owner, const std::vector<Quad>& quads, vk::Extent2D pictureSize)
        : device(owner),
          size(pictureSize),
          scene(sceneOf(quads)),
          gpuScene(owner, scene),
          cull(owner),
          capture(owner, gpuScene.features()),
          shadowCapture(owner, gpuScene.features(), visibility::CaptureSs::Writes::depthOnly),
          coarse(owner),
          eyeList(owner, gpuScene, "eye"),
          lightList(owner, gpuScene, "light"),
          viewBuffer(owner, "view", sizeof(shared::ViewParams), gpu::Residence::mapped),
          lightBuffer(owner, "light", sizeof(shared::LightParams), gpu::Residence::mapped),
          ids(target(size, vk::Format::eR32Uint, Usage::eColorAttachment)),
          depth(target(size, vk::Format::eD32Sfloat, Usage::eDepthStencilAttachment)),
          sunMap(depthMaps(1)),
          skyMaps(depthMaps(kSkyViews)),
          terms(target(size, vk::Format::eR16G16B16A16Sfloat, Usage::eStorage)),
          covered(owner, size, "covered"),
          texels(target(size, vk::Format::eR32G32B32A32Uint, Usage::eStorage)) {}

    /// Draws the terms: at full rate to `terms`, and at `rate` to `texels`.
    void draw(vec3 toSun, const scene::Camera& camera, std::uint32_t taps, float rate = 1) {
        const float aspect = float(size.width) / float(size.height);
        const glm::mat4 clipFromView = camera.clipFromView(aspect);
        const glm::mat4 clipFromWorld = clipFromView * camera.viewFromWorld();
        sun = fitSun(toSun, gpuScene.bounds(), camera, aspect, 1e5f, kMapSize);
        const auto skyViews = fitSky(Sky(toSun), gpuScene.bounds(), kSkyViews, kMapSize);
        light = {.toSun = toSun, .shadowTaps = taps, .skyViewCount = kSkyViews, .skyTaps = 2};
        light.views[0] = sun.params();
        for (std::size_t i = 0; i < kSkyViews; ++i) light.views[i + 1] = skyViews[i].params();
        *lightBuffer.mapped<shared::LightParams>() = light;
        *viewBuffer.mapped<shared::ViewParams>() = {
            .clipFromWorld = clipFromWorld,
            .viewFromWorld = camera.viewFromWorld(),
            .eye = camera.eye,
            .clipScale = {clipFromView[0][0], clipFromView[1][1]}};

        gpu::Recorder rec(device);
        rec.begin();
        const auto drawMap = [&](const LightView& from, gpu::View map) {
            cull.record(rec, gpuScene,
                        {.clipFromWorld = from.clipFromWorld,
                         .size = map.extent,
                         .perspective = false,
                         .keepBeforeNear = true},
                        lightList);
            rec.barrier(Stage::compute, Stage::raster);
            rec.barrier(Stage::compute, Stage::indirect);
            shadowCapture.record(rec, gpuScene, lightList, from.clipFromWorld, {{}, map}, "map");
            rec.barrier(Stage::raster, Stage::compute);
            rec.barrier(Stage::indirect, Stage::compute);
        };
        drawMap(sun, sunMap.layer(0));
        for (std::uint32_t i = 0; i < kSkyViews; ++i) drawMap(skyViews[i], skyMaps.layer(i));
        cull.record(rec, gpuScene, {clipFromWorld, camera.eye, size}, eyeList);
        rec.barrier(Stage::compute, Stage::raster);
        rec.barrier(Stage::compute, Stage::indirect);
        capture.record(rec, gpuScene, eyeList, clipFromWorld, {ids, depth}, "capture");
        rec.barrier(Stage::raster, Stage::compute);
        const Coarse::Inputs inputs{ids, sunMap, skyMaps, viewBuffer, lightBuffer};
        coarse.recordFull(rec, gpuScene, inputs, shared::LS_ALL_TERMS, terms);
        coarse.record(rec, gpuScene, inputs, shared::LS_ALL_TERMS, rate, covered, texels);
        rec.submit();
    }

    std::vector<vec4> fullTerms() const {
        std::vector<vec4> values;
        for (const auto bits : gpu::as<std::uint64_t>(gpu::readImage(device, terms)))
            values.push_back(glm::unpackHalf4x16(bits));
        return values;
    }

    DepthMaps readMaps() const {
        DepthMaps read{.size = int(kMapSize), .maps = {}};
        read.maps.push_back(gpu::as<float>(gpu::readImage(device, sunMap)));
        for (std::uint32_t i = 0; i < kSkyViews; ++i)
            read.maps.push_back(gpu::as<float>(gpu::readImage(device, skyMaps, i)));
        return read;
    }

    gpu::Image target(vk::Extent2D extent, vk::Format format, Usage usage) const {
        return {device,
                {.name = "target",
                 .format = format,
                 .extent = extent,
                 .usage = Usage::eSampled | Usage::eTransferSrc | usage}};
    }

    gpu::Image depthMaps(std::uint32_t layers) const {
        return {device,
                {.name = "depth maps",
                 .format = vk::Format::eD32Sfloat,
                 .extent = {kMapSize, kMapSize},
                 .usage = Usage::eSampled | Usage::eTransferSrc | Usage::eDepthStencilAttachment,
                 .layers = layers,
                 .array = true}};
    }

    const gpu::Device& device;
    vk::Extent2D size;
    scene::Scene scene;
    scene::GpuScene gpuScene;
    geometry::Cull cull;
    visibility::CaptureSs capture, shadowCapture;
    Coarse coarse;
    geometry::DrawList eyeList, lightList;
    gpu::Buffer viewBuffer, lightBuffer;
    gpu::Image ids, depth, sunMap, skyMaps, terms;
    gpu::TexelList covered;
    gpu::Image texels;
    LightView sun;
    shared::LightParams light;
};

class CoarseGpu : public GpuTest {};

const std::vector<Quad> kSquareOverFloor{floorQuad(2), {{-0.5, 0.5, -0.5}, {0, 0, 1}, {1, 0, 0}}};
const scene::Camera kFromAbove{.eye = {1.5f, 2.5f, 2}, .at = {0, 0.2f, 0}, .verticalFov = 0.9f};
const vec3 kSun{0.4f, 0.8f, -0.3f};

dvec2 ndcOf(dvec2 pixel, vk::Extent2D size) {
    return pixel / dvec2(size.width, size.height) * 2.0 - 1.0;
}

TEST_F(CoarseGpu, visibilitiesAreTheReferenceAtEveryPixel) {
    Rig rig(device(), kSquareOverFloor, {97, 61});
    const double aspect = 97.0 / 61;
    for (const std::uint32_t taps : {0u, 1u, 4u, 9u}) {
        rig.draw(kSun, kFromAbove, taps);
        const DepthMaps maps = rig.readMaps();
        const auto terms = rig.fullTerms();
        int lit = 0, dark = 0, between = 0, open = 0, covered = 0;
        for (std::size_t i = 0; i < terms.size(); ++i) {
            const auto hit =
                look(kSquareOverFloor, kFromAbove,
                     ndcOf({double(i % 97) + 0.5, double(i / 97) + 0.5}, rig.size), aspect);
            if (!hit || hit->nearEdge) continue;
            const double sun = maps.sunVisibility(rig.light, *hit);
            const double sky = maps.skyVisibility(rig.light, *hit);
            ASSERT_NEAR(terms[i].x, sun, 2e-3) << taps << " taps, pixel " << i;
            ASSERT_NEAR(terms[i].y, sky, 2e-3) << "pixel " << i;
            ++(sun > 1 - 1e-6 ? lit : sun < 1e-6 ? dark : between);
            open += sky > 0.95;
            covered += sky < 0.8;
        }
        EXPECT_GT(lit, 500) << taps;
        EXPECT_GT(open, 300);
        EXPECT_GT(covered, 15) << "below the square";
        if (taps > 0) {
            EXPECT_GT(dark, 15) << taps;
            EXPECT_GT(between, 20) << taps;
        }
    }
}

TEST_F(CoarseGpu, aPlaneIsLitAtEveryTiltToTheSun) {
    Rig rig(device(), {floorQuad(2)}, {40, 30});
    std::mt19937 random(31);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int i = 0; i < 100; ++i) {
        const float tilt = glm::radians(80.f) * unit(random), turn = 6.2831853f * unit(random);
        rig.draw({std::sin(tilt) * std::cos(turn), std::cos(tilt), std::sin(tilt) * std::sin(turn)},
                 kFromAbove, 9);
        for (const vec4& terms : rig.fullTerms()) {
            ASSERT_GT(terms.x, 0.999) << "tilt " << glm::degrees(tilt) << " turn " << turn;
            ASSERT_GT(terms.y, 0.999) << "sky";
        }
    }
}

TEST_F(CoarseGpu, texelsHoldWhatTheirCentresSee) {
    const vk::Extent2D full{97, 61};
    Rig rig(device(), kSquareOverFloor, full);
    for (const float rate : {1.0f, 2.5f, 7.3f}) {
        rig.draw(kSun, kFromAbove, 9, rate);
        const DepthMaps maps = rig.readMaps();
        const auto texels = gpu::as<glm::uvec4>(gpu::readImage(device(), rig.texels));
        const vk::Extent2D extent = coarseExtent(full, rate);
        int surfaces = 0, empty = 0;
        for (std::uint32_t y = 0; y < extent.height; ++y)
            for (std::uint32_t x = 0; x < extent.width; ++x) {
                // The last texels may reach past the picture: their centres stay inside.
                const dvec2 centre = glm::min(dvec2(x + 0.5, y + 0.5) * double(rate),
                                              dvec2(full.width, full.height) - 0.5);
                // The triangle is that of the pixel about the centre, met in its plane.
                const auto pixel = look(kSquareOverFloor, kFromAbove,
                                        ndcOf(glm::floor(centre) + 0.5, full), 97.0 / 61);
                const auto hit = look(kSquareOverFloor, kFromAbove, ndcOf(centre, full), 97.0 / 61);
                const glm::uvec4 texel = texels[y * full.width + x];
                const float depth = glm::uintBitsToFloat(texel.z);
                const glm::vec2 visible = glm::unpackHalf2x16(texel.x);
                if (!pixel && !hit) {
                    EXPECT_EQ(depth, 0);
                    EXPECT_EQ(visible, glm::vec2(1));
                    ++empty;
                    continue;
                }
                if (!pixel || !hit || pixel->nearEdge || hit->nearEdge ||
                    pixel->normal != hit->normal ||
                    std::abs(pixel->position.y - hit->position.y) > 1e-6)
                    continue;
                ++surfaces;
                ASSERT_NEAR(depth, hit->depth, 1e-4 * hit->depth) << x << ',' << y << " r=" << rate;
                ASSERT_NEAR(visible.x, maps.sunVisibility(rig.light, *hit), 2e-3)
                    << x << ',' << y << " r=" << rate;
                ASSERT_NEAR(visible.y, maps.skyVisibility(rig.light, *hit), 2e-3)
                    << x << ',' << y << " r=" << rate;
                const vec3 n = glm::mat3(kFromAbove.viewFromWorld()) * vec3(hit->normal);
                EXPECT_NEAR(glm::unpackHalf2x16(texel.w).x, n.x / n.z, 3e-3);
                EXPECT_NEAR(glm::unpackHalf2x16(texel.w).y, n.y / n.z, 3e-3);
            }
        EXPECT_GT(surfaces, int(extent.width * extent.height) / 2) << "r=" << rate;
        EXPECT_GT(empty, 0) << "r=" << rate;
    }
}

TEST_F(CoarseGpu, fullRateTermsAreThoseOfTexelsAtRateOne) {
    Rig rig(device(), kSquareOverFloor, {33, 17});
    rig.draw(kSun, kFromAbove, 5, 1);
    const auto texels = gpu::as<glm::uvec4>(gpu::readImage(device(), rig.texels));
    const auto terms = rig.fullTerms();
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const vec4 packed(glm::unpackHalf2x16(texels[i].x), glm::unpackHalf2x16(texels[i].y));
        for (int c = 0; c < 4; ++c) EXPECT_NEAR(terms[i][c], packed[c], 1e-3) << i;
    }
}

TEST(CoarseExtent, coversThePictureAndRefusesRatesBelowOne) {
    EXPECT_EQ(coarseExtent({1280, 720}, 1), vk::Extent2D(1280, 720));
    EXPECT_EQ(coarseExtent({1280, 720}, 2), vk::Extent2D(640, 360));
    EXPECT_EQ(coarseExtent({17, 33}, 3.5f), vk::Extent2D(5, 10));
    EXPECT_EQ(coarseExtent({1, 1}, 7.3f), vk::Extent2D(1, 1));
    for (const float bad : {0.99f, 0.f, -2.f, std::nanf("")})
        EXPECT_THROW(coarseExtent({8, 8}, bad), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::shading

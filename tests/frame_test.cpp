// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include <glm/gtc/packing.hpp>

#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>
#include <lodestar/scene/procedural.hpp>

#include "golden.hpp"
#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {
namespace {

using scene::Camera;
using scene::Scene;

FrameSettings small(std::uint32_t width, std::uint32_t height) {
    return {.size = {width, height}, .shadowMapSize = 512};
}

Camera cameraOf(const Scene& scene, std::size_t index) {
    const scene::SceneCamera& camera = scene.cameras.at(index);
    return scene::fromSceneCamera(camera, worldFromNode(scene)[camera.node], 5);
}

/// A scene on the device and its frame.
struct Stage {
    Scene source;
    scene::GpuScene onGpu;
    Frame frame;
    const gpu::Device& device;

    Stage(const gpu::Device& owner, Scene scene, const FrameSettings& settings)
        : source(std::move(scene)),
          onGpu(owner, source),
          frame(owner, onGpu, settings),
          device(owner) {}

    quality::RgbImage render(const Camera& camera, float rate = 1) {
        frame.render(camera, {.shadingRate = rate});
        const vk::Extent2D size = frame.settings().size;
        quality::RgbImage picture(int(size.width), int(size.height));
        const auto rgba = gpu::readImage(device, frame.display());
        for (std::size_t i = 0; i < picture.rgb.size(); ++i)
            picture.rgb[i] = std::uint8_t(rgba[i / 3 * 4 + i % 3]);
        return picture;
    }
    std::vector<std::uint32_t> ids() const {
        return gpu::as<std::uint32_t>(gpu::readImage(device, frame.ids()));
    }
    std::vector<glm::vec4> halves(const gpu::View& image) const {
        std::vector<glm::vec4> texels;
        for (const std::uint64_t bits : gpu::as<std::uint64_t>(gpu::readImage(device, image)))
            texels.push_back(glm::unpackHalf4x16(bits));
        return texels;
    }
    void expectFinite() const {
        for (const glm::vec4& texel : halves(frame.radiance()))
            for (int c = 0; c < 3; ++c) {
                ASSERT_TRUE(std::isfinite(texel[c]));
                ASSERT_GE(texel[c], 0);
            }
    }
};

class FrameTest : public GpuTest {};

TEST_F(FrameTest, columnsAtFullRateAreReproducibleAndCoarseOnesClose) {
    Stage stage(device(), *scene::buildBuiltin("columns"), small(128, 72));
    const Camera camera = cameraOf(stage.source, 0);
    const auto full = stage.render(camera);
    expectGolden(full, "columns");
    const std::uint64_t bytes = device().allocatedBytes();
    for (const float rate : {1.5f, 2.0f, 3.7f}) {
        const auto coarse = stage.render(camera, rate);
        EXPECT_NE(coarse.rgb, full.rgb) << rate;
        EXPECT_GT(quality::psnr(full, coarse), rate < 2 ? 31 : rate < 3 ? 29 : 27) << rate;
    }
    EXPECT_EQ(stage.render(camera).rgb, full.rgb);
    EXPECT_EQ(device().allocatedBytes(), bytes) << "a frame allocated memory";
}

TEST_F(FrameTest, shadingAsAWholeOnGridSIsCoarserThanItsExpensiveTermsAlone) {
    Stage stage(device(), *scene::buildBuiltin("columns"), small(128, 72));
    FrameSettings plain = small(128, 72);
    plain.reconstruct = upsample::Reconstruct::bilinear;
    Frame conventional(device(), stage.onGpu, plain);
    const Camera camera = cameraOf(stage.source, 0);
    const auto full = stage.render(camera);
    const auto psnrOf = [&](Frame& frame, const budget::Levers& levers) {
        frame.render(camera, levers);
        quality::RgbImage picture(128, 72);
        const auto rgba = gpu::readImage(device(), frame.display());
        for (std::size_t i = 0; i < picture.rgb.size(); ++i)
            picture.rgb[i] = std::uint8_t(rgba[i / 3 * 4 + i % 3]);
        return quality::psnr(full, picture);
    };
    for (const float rate : {1.5f, 3.0f}) {
        const double guided = psnrOf(stage.frame, {.shadingRate = rate, .resizeAll = true});
        const double bilinear = psnrOf(conventional, {.shadingRate = rate, .resizeAll = true});
        const double fine = psnrOf(stage.frame, {.shadingRate = rate});
        EXPECT_GT(guided, bilinear) << rate;
        EXPECT_GT(fine, guided + 3) << rate;
        EXPECT_GT(bilinear, 15) << rate;
    }
    EXPECT_EQ(stage.render(camera).rgb, full.rgb);
}

TEST_F(FrameTest, spheresLookAsTheyDid) {
    Stage stage(device(), *scene::buildBuiltin("spheres"), small(128, 72));
    const Camera camera = cameraOf(stage.source, 0);
    const auto full = stage.render(camera);
    expectGolden(full, "spheres");
    EXPECT_GT(quality::psnr(full, stage.render(camera, 1.5f)), 35);
    stage.expectFinite();
}

TEST_F(FrameTest, turnedStretchedAndReflectedInstancesLookAsTheyDid) {
    Stage stage(device(), small_scenes::jumble(), small(96, 64));
    expectGolden(stage.render(scene::frame(stage.onGpu.bounds(), 1.5f)), "jumble");
}

TEST_F(FrameTest, everyPassIsTimed) {
    FrameSettings settings = small(32, 32);
    settings.skyViews = 1;
    Stage stage(device(), small_scenes::single(small_scenes::quad()), settings);
    const auto namesAt = [&](const budget::Levers& levers) {
        const auto times = stage.frame.render(small_scenes::facing(), levers);
        std::string names;
        double sum = 0;
        for (const auto& pass : times.passes) {
            names += pass.name + ", ";
            sum += pass.ms;
        }
        EXPECT_LE(sum, times.gpuMs * 1.001);
        return names;
    };
    const std::string capture = device().hasInt64Atomics() ? "cull, cull triangles, capture, ids, "
                                                           : "cull, cull triangles, capture, ";
    const std::string coarse = "list tiles, background, rebuild, list terms, terms, ";
    EXPECT_EQ(namesAt({.shadingRate = 2}),
              "cull, cull triangles, shadow map, cull, cull triangles, sky map, " + capture +
                  coarse + "combine, tonemap, ");
    // The depth maps of an unmoved scene are kept. Grids of two rates are joined on O.
    EXPECT_EQ(namesAt({.shadingRate = 4, .split = {1, 0.5f, 1}}),
              capture + coarse + "upsample, list terms, terms, upsample, combine, tonemap, ");
    EXPECT_EQ(namesAt({}), capture + "list tiles, background, rebuild, terms, combine, tonemap, ");
}

TEST_F(FrameTest, termsLeftOnGridSShadeAsThoseReconstructedBefore) {
    using upsample::Reconstruct;
    for (const Reconstruct kind : {Reconstruct::bilateral, Reconstruct::bilinear,
                                   Reconstruct::biquadratic, Reconstruct::nearestDepth}) {
        FrameSettings settings = small(75, 45);
        settings.noiseOctaves = 3;
        settings.reconstruct = kind;
        settings.sigmas = {.z = 0.05f, .n = 0.7f};
        Stage onS(device(), small_scenes::jumble(), settings);
        settings.keepTerms = true;
        Stage onO(device(), small_scenes::jumble(), settings);
        const Camera camera = scene::frame(onS.onGpu.bounds(), 0.8f);
        for (const budget::Levers& levers :
             {budget::Levers{.shadingRate = 1.5f}, budget::Levers{.shadingRate = 3.7f},
              budget::Levers{.shadingRate = 5, .repair = 0.04f}}) {
            onS.frame.render(camera, levers);
            onO.frame.render(camera, levers);
            EXPECT_EQ(onS.frame.repairedPixels(), onO.frame.repairedPixels());
            const bool repairs = levers.repair > 0 && kind != Reconstruct::bilinear &&
                                 kind != Reconstruct::nearestDepth;
            EXPECT_EQ(onS.frame.repairedPixels() > 50, repairs);
            const auto left = onS.halves(onS.frame.radiance());
            const auto before = onO.halves(onO.frame.radiance());
            for (std::size_t i = 0; i < left.size(); ++i)
                ASSERT_LT(glm::distance(left[i], before[i]), 0.003f * glm::length(before[i]))
                    << "pixel " << i << ", rate " << levers.shadingRate << ", filter " << int(kind);
        }
    }
}

TEST_F(FrameTest, oddSizesWork) {
    for (const vk::Extent2D size : {vk::Extent2D{1, 1}, {17, 33}}) {
        Stage stage(device(), small_scenes::jumble(), small(size.width, size.height));
        const Camera camera = scene::frame(stage.onGpu.bounds(), 0.5f);
        for (const float rate : {1.0f, 2.5f, 40.0f}) {
            stage.render(camera, rate);
            stage.expectFinite();
        }
    }
}

TEST_F(FrameTest, anEmptySceneIsSky) {
    FrameSettings settings = small(64, 48);
    settings.toSun = {0, 1, 0};  // out of the picture
    Stage stage(device(), {}, settings);
    const Camera camera{.eye = {0, 1, 0}, .at = {0, 1.2f, -1}, .verticalFov = 0.8f};
    stage.render(camera, 1);
    EXPECT_EQ(stage.ids(), std::vector<std::uint32_t>(64 * 48, 0));
    const auto radiance = stage.halves(stage.frame.radiance());
    const shading::Sky sky(settings.toSun);
    const glm::mat3 worldFromView = glm::transpose(glm::mat3(camera.viewFromWorld()));
    const float tall = std::tan(0.4f);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::vec2 ndc((float(x) + 0.5f) / 32 - 1, (float(y) + 0.5f) / 24 - 1);
            const glm::vec3 direction = glm::normalize(
                worldFromView * glm::vec3(ndc.x * tall * 64 / 48, -ndc.y * tall, -1));
            if (std::abs(direction.y) < 0.05f) continue;  // the map blurs the horizon
            const glm::vec3 expected = sky.radiance(direction);
            const glm::vec3 seen(radiance[std::size_t(y * 64 + x)]);
            EXPECT_LT(glm::length(seen - expected), 0.03f * glm::length(expected)) << x << ' ' << y;
        }
}

TEST_F(FrameTest, shadowsDarkenWhatLiesBehindTheirCasters) {
    // A plate above a floor, the sun straight above both.
    const auto scene = [] {
        small_scenes::SceneBuilder builder("plate");
        const auto floor = small_scenes::parts::rectangle({-4, 0, -4}, {8, 0, 0}, {0, 0, 8});
        const auto plate = small_scenes::parts::rectangle({-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
        const std::uint32_t material = builder.add(scene::Material{});
        builder.place(
            builder.add("floor", small_scenes::parts::patch(floor, 1, 1, {1, 1}), material));
        builder.place(
            builder.add("plate", small_scenes::parts::patch(plate, 1, 1, {1, 1}), material));
        return std::move(builder).finish();
    }();
    // From the side, under the plate's height: the middle of the floor and its left edge.
    const Camera camera{.eye = {0, 0.8f, 6}, .at = {0, 0, 0}, .verticalFov = 0.9f};
    const auto sunAt = [&](std::uint32_t taps) {
        FrameSettings settings = small(64, 48);
        settings.toSun = {0, 1, 0};
        settings.shadowTaps = taps;
        settings.keepTerms = true;
        Stage stage(device(), scene, settings);
        stage.render(camera);
        const auto ids = stage.ids();
        const auto terms = stage.halves(stage.frame.terms());
        const auto at = [&](float x) {  // a point of the floor, z = 0
            const glm::vec4 clip =
                camera.clipFromView(64.0f / 48) * camera.viewFromWorld() * glm::vec4(x, 0, 0, 1);
            const glm::vec2 pixel = (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * glm::vec2(64, 48);
            const auto index = std::size_t(pixel.y) * 64 + std::size_t(pixel.x);
            EXPECT_NE(ids[index], 0u);
            return terms[index].x;
        };
        return std::pair{at(0), at(-2.5f)};
    };
    for (const std::uint32_t taps : {1u, 9u}) {
        const auto [under, beside] = sunAt(taps);
        EXPECT_LT(under, 0.02f) << taps;
        EXPECT_GT(beside, 0.98f) << taps;
    }
    const auto [under, beside] = sunAt(0);
    EXPECT_EQ(under, 1);
    EXPECT_EQ(beside, 1);
}

TEST_F(FrameTest, animationMovesThePictureAndBack) {
    Scene scene = small_scenes::single(small_scenes::quad());
    scene.animations.push_back({.name = "slide",
                                .duration = 2,
                                .channels = {{.node = scene.instances[0].node,
                                              .path = scene::AnimationPath::translation,
                                              .times = {0, 2},
                                              .values = {glm::vec4(0), glm::vec4(4, 0, 0, 0)}}}});
    Stage stage(device(), std::move(scene), small(32, 32));
    const auto first = stage.render(small_scenes::facing());
    stage.onGpu.animate(0.5f);  // one unit, half of the picture, to the right
    const auto moved = stage.render(small_scenes::facing());
    const auto ids = stage.ids();
    for (std::size_t i = 0; i < ids.size(); ++i)
        EXPECT_EQ(ids[i] != 0, i % 32 >= 16) << "pixel " << i;
    EXPECT_NE(moved.rgb, first.rgb);
    stage.onGpu.animate(0);
    EXPECT_EQ(stage.render(small_scenes::facing()).rgb, first.rgb);
}

TEST_F(FrameTest, unlitSurfacesKeepTheirColorAndEmittersShine) {
    Scene scene = small_scenes::single(small_scenes::quad(),
                                       {.baseColor = {0.5f, 0.25f, 1, 1}, .unlit = true});
    Stage unlit(device(), scene, small(16, 16));
    unlit.render(small_scenes::facing());
    for (const glm::vec4& texel : unlit.halves(unlit.frame.radiance()))
        ASSERT_LT(glm::length(glm::vec3(texel) - glm::vec3(0.5f, 0.25f, 1)), 0.01f);

    const auto radianceOf = [&](glm::vec3 emissive) {
        scene.materials[0] = {.baseColor = {0.2f, 0.2f, 0.2f, 1}, .emissive = emissive};
        Stage stage(device(), scene, small(16, 16));
        stage.render(small_scenes::facing());
        return stage.halves(stage.frame.radiance());
    };
    const auto dark = radianceOf({0, 0, 0}), bright = radianceOf({5, 0, 1});
    for (std::size_t i = 0; i < dark.size(); ++i)
        ASSERT_LT(glm::length(glm::vec3(bright[i] - dark[i]) - glm::vec3(5, 0, 1)), 0.02f);
}

TEST_F(FrameTest, withoutTermsNothingIsInShadow) {
    FrameSettings settings = small(16, 16);
    settings.shadowTaps = settings.skyViews = 0;
    Stage stage(device(), small_scenes::single(small_scenes::quad()), settings);
    for (int frame = 0; frame < 2; ++frame) {
        stage.render(small_scenes::facing());
        for (const glm::vec4& term : stage.halves(stage.frame.terms())) {
            ASSERT_EQ(term.x, 1) << "the sun is seen";
            ASSERT_EQ(term.y, 1) << "the sky is seen";
            ASSERT_EQ(term.w, 0) << "the screen occludes nothing";
        }
    }
}

TEST_F(FrameTest, aBackdropShowsItsColourPastTheSurfacesAndLeavesThemAlone) {
    // Of 20 pixels a side some tiles are empty and some half covered: either has its own pass.
    constexpr std::uint32_t kSize = 20;
    FrameSettings settings = small(kSize, kSize);
    settings.exposure = 1.7f;
    Stage withSky(device(), *scene::buildBuiltin("spheres"), settings);
    settings.backdrop = glm::vec3(200, 60, 20) / 255.0f;
    Stage plain(device(), *scene::buildBuiltin("spheres"), settings);
    Camera camera = cameraOf(plain.source, 0);
    camera.eye = camera.at + 3.0f * (camera.eye - camera.at);
    const auto before = withSky.render(camera);
    const auto expectBackdrop = [&](const quality::RgbImage& picture, bool sameSurfaces) {
        const auto ids = plain.ids();
        std::size_t past = 0;
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const auto* shown = &picture.rgb[3 * i];
            if (ids[i] != 0) {
                for (std::size_t c = 0; sameSurfaces && c < 3; ++c)
                    ASSERT_EQ(shown[c], before.rgb[3 * i + c]) << i;
                continue;
            }
            ++past;
            ASSERT_NEAR(shown[0], 200, 1) << i;
            ASSERT_NEAR(shown[1], 60, 1) << i;
            ASSERT_NEAR(shown[2], 20, 1) << i;
        }
        EXPECT_GT(past, 20u);
        EXPECT_LT(past, ids.size() - 20);
    };
    expectBackdrop(plain.render(camera), true);
    expectBackdrop(plain.render(camera, 2), false);
}

TEST_F(FrameTest, aDirectionalLightGivesTheSunItsColourAndALuxItsWorth) {
    const auto litBy = [&](std::optional<scene::Light> light) {
        Scene scene = small_scenes::single(small_scenes::quad());
        scene.materials[0] = {
            .baseColor = {1, 1, 1, 1}, .metallic = 0, .roughness = 1, .emissive = {0, 0, 1}};
        if (light) scene.lights.push_back(*light);  // along the quad's node: straight at it
        FrameSettings settings = small(16, 16);
        settings.toSun = {0, 0, 1};
        settings.shadowTaps = 0;
        Stage stage(device(), std::move(scene), settings);
        stage.render(small_scenes::facing());
        return glm::vec3(stage.halves(stage.frame.radiance())[8 * 16 + 8]);
    };
    const glm::vec3 dark = litBy(scene::Light{.intensity = 0});
    const glm::vec3 red = litBy(scene::Light{.color = {1, 0, 0}, .intensity = 1}) - dark;
    const glm::vec3 weak = litBy(scene::Light{.intensity = 1}) - dark;
    const glm::vec3 strong = litBy(scene::Light{.intensity = 10}) - dark;
    EXPECT_GT(red.x, 0.5f);
    EXPECT_NEAR(red.y, 0, 1e-2);
    // Ten times the sun: the same picture but for the emissive surface, a tenth beside it.
    EXPECT_NEAR(weak.x, strong.x, 2e-2);
    EXPECT_GT(weak.z, strong.z + 0.5f);
}

TEST_F(FrameTest, settingsOutOfRangeAreRefused) {
    const Scene source = small_scenes::single(small_scenes::quad());
    const scene::GpuScene onGpu(device(), source);
    const auto refuses = [&](auto change) {
        FrameSettings settings = small(16, 16);
        change(settings);
        EXPECT_THROW(Frame(device(), onGpu, settings), std::invalid_argument);
    };
    refuses([](FrameSettings& s) { s.size.width = 0; });
    refuses([](FrameSettings& s) { s.size.height = 16385; });
    refuses([](FrameSettings& s) { s.shadowTaps = 129; });
    refuses([](FrameSettings& s) { s.shadowMapSize = 15; });
    refuses([](FrameSettings& s) { s.shadowMapSize = 16385; });
    refuses([](FrameSettings& s) { s.skyViews = 17; });
    refuses([](FrameSettings& s) { s.skyTaps = 0; });
    refuses([](FrameSettings& s) { s.skyMapSize = 8; });
    refuses([](FrameSettings& s) { s.exposure = -1; });
    refuses([](FrameSettings& s) { s.backdrop = glm::vec3(0, 0, 1.1f); });
    refuses([](FrameSettings& s) { s.capture = CaptureBackend::multisample; });

    FrameSettings settings = small(16, 16);
    settings.sigmas.z = 0;
    Frame frame(device(), onGpu, settings);
    EXPECT_THROW(frame.render(small_scenes::facing(), {.shadingRate = 2}), std::invalid_argument);
}

TEST_F(FrameTest, aFrameGivesItsMemoryBack) {
    const Scene source = small_scenes::single(small_scenes::quad());
    const scene::GpuScene onGpu(device(), source);
    const std::uint64_t before = device().allocatedBytes();
    {
        Frame frame(device(), onGpu, small(64, 64));
        frame.render(small_scenes::facing(), {});
        EXPECT_GT(device().allocatedBytes(), before + 512 * 512 * 4);
    }
    EXPECT_EQ(device().allocatedBytes(), before);
}

/// The picture the frame holds, and its linear radiance averaged over n × n pixels.
quality::RgbImage pictureOf(const Stage& stage) {
    const vk::Extent2D size = stage.frame.settings().size;
    quality::RgbImage picture(int(size.width), int(size.height));
    const auto rgba = gpu::readImage(stage.device, stage.frame.display());
    for (std::size_t i = 0; i < picture.rgb.size(); ++i)
        picture.rgb[i] = std::uint8_t(rgba[i / 3 * 4 + i % 3]);
    return picture;
}

TEST_F(FrameTest, rebuiltAtTheCaptureRateThePictureIsThatOfDirectRaster) {
    Stage stage(device(), *scene::buildBuiltin("spheres"), small(96, 64));
    const Camera camera = cameraOf(stage.source, 1);
    const auto direct = stage.render(camera);
    for (const std::uint32_t side : {1u, 2u, 8u}) {
        CaptureFrame capture(
            device(), stage.onGpu,
            {.base = {96 / side, 64 / side}, .side = side, .backend = CaptureBackend::supersample});
        capture.capture(camera);
        stage.frame.rebuild(capture.compact(), camera, {});
        EXPECT_EQ(pictureOf(stage).rgb, direct.rgb) << side;
    }
}

TEST_F(FrameTest, capturedInComputeThePictureIsThatOfRasterButForSnapping) {
    if (!device().hasInt64Atomics()) GTEST_SKIP() << "no 64-bit atomics";
    for (const char* name : {"columns", "spheres"})
        for (const float scale : {1.0f, 0.7f}) {
            SCOPED_TRACE(testing::Message() << name << " " << scale);
            std::vector<std::vector<std::uint8_t>> pictures;
            for (const auto backend : {CaptureBackend::supersample, CaptureBackend::compute}) {
                FrameSettings settings = small(120, 80);
                settings.capture = backend;
                settings.cull = geometry::CullMode::hiz;
                Stage stage(device(), *scene::buildBuiltin(name), settings);
                const Camera camera = cameraOf(stage.source, 1);
                stage.frame.render(camera, {.renderScale = scale});
                const auto passes = stage.frame.render(camera, {.renderScale = scale}).passes;
                EXPECT_EQ(std::any_of(passes.begin(), passes.end(),
                                      [](const auto& pass) { return pass.name == "ids"; }),
                          backend == CaptureBackend::compute);
                const auto rgba = gpu::readImage(device(), stage.frame.display());
                pictures.emplace_back();
                for (const auto byte : rgba) pictures.back().push_back(std::uint8_t(byte));
            }
            std::size_t unlike = 0;
            for (std::size_t i = 0; i < pictures[0].size(); ++i)
                unlike += std::abs(int(pictures[0][i]) - int(pictures[1][i])) > 2;
            EXPECT_LT(unlike, pictures[0].size() / 50);
        }
}

TEST_F(FrameTest, antialiasedOutputComesCloseToSupersampledShading) {
    constexpr std::uint32_t kWidth = 64, kHeight = 40, kSide = 8;
    for (const char* name : {"spheres", "columns"}) {
        SCOPED_TRACE(name);
        FrameSettings settings = small(kWidth * kSide, kHeight * kSide);
        settings.shadowTaps = 9;
        Stage fine(device(), *scene::buildBuiltin(name), settings);
        const Camera camera = cameraOf(fine.source, 0);
        fine.render(camera);
        const auto samples = fine.halves(fine.frame.radiance());
        std::vector<glm::vec3> expected(kWidth * kHeight);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const std::size_t x = i % (kWidth * kSide), y = i / (kWidth * kSide);
            expected[y / kSide * kWidth + x / kSide] += glm::vec3(samples[i]) / 64.0f;
        }

        settings.size = vk::Extent2D{kWidth, kHeight};
        Stage coarse(device(), *scene::buildBuiltin(name), settings);
        coarse.render(camera);
        const auto plain = coarse.halves(coarse.frame.radiance());
        CaptureFrame capture(device(), coarse.onGpu, {.base = {kWidth, kHeight}, .side = kSide});
        capture.capture(camera);
        coarse.frame.rebuildAntialiased(capture.compact(), camera);
        const auto smooth = coarse.halves(coarse.frame.radiance());
        EXPECT_GT(coarse.frame.furtherFragments(), 20u);
        EXPECT_LT(coarse.frame.furtherFragments(), 7 * kWidth * kHeight);
        // Which thread lists what first changes nothing.
        coarse.frame.rebuildAntialiased(capture.compact(), camera);
        EXPECT_EQ(coarse.halves(coarse.frame.radiance()), smooth);
        // Tone-mapped roughly as the eye does, so that highlights do not outweigh the rest.
        const auto error = [&](const std::vector<glm::vec4>& picture) {
            double sum = 0;
            for (std::size_t i = 0; i < expected.size(); ++i) {
                const auto curve = [](glm::vec3 c) { return glm::sqrt(c / (1.0f + c)); };
                const glm::vec3 d = curve(glm::vec3(picture[i])) - curve(expected[i]);
                sum += glm::dot(d, d) / 3;
            }
            return std::sqrt(sum / double(expected.size()));
        };
        EXPECT_LT(error(smooth), 0.8 * error(plain)) << error(smooth) << " " << error(plain);
    }
}

TEST_F(FrameTest, antialiasingAPictureOfOneSurfaceShadesItOnce) {
    Stage stage(device(), small_scenes::single(small_scenes::quad()), small(40, 40));
    const Camera camera = small_scenes::facing();
    const auto plain = stage.render(camera);
    CaptureFrame capture(device(), stage.onGpu, {.base = {40, 40}, .side = 8});
    capture.capture(camera);
    stage.frame.rebuildAntialiased(capture.compact(), camera);
    EXPECT_EQ(stage.frame.furtherFragments(), 0u);  // the sky around it is a neighbour's too
    EXPECT_GT(quality::psnr(plain, pictureOf(stage)), 50);
}

TEST_F(FrameTest, severalSamplesAPixelAreCapturedAndBlendedInOneGo) {
    FrameSettings settings = small(48, 32);
    settings.captureSide = 4;
    settings.capture = CaptureBackend::supersample;
    Stage stage(device(), *scene::buildBuiltin("spheres"), settings);
    const Camera camera = cameraOf(stage.source, 1);
    const auto inOne = stage.render(camera);
    EXPECT_EQ(stage.frame.ids().extent, settings.size);
    CaptureFrame capture(
        device(), stage.onGpu,
        {.base = settings.size, .side = 4, .backend = CaptureBackend::supersample});
    capture.capture(camera);
    stage.frame.rebuildAntialiased(capture.compact(), camera);
    EXPECT_EQ(pictureOf(stage).rgb, inOne.rgb);
}

}  // namespace
}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {
namespace {

using geometry::CullMode;
using geometry::LodChoice;
using scene::Camera;
using scene::Scene;

constexpr vk::Extent2D kSize{93, 61};

/// A town of blocks with small things among them, some of which move.
Scene town(std::uint32_t seed) {
    small_scenes::Random random(seed);
    small_scenes::SceneBuilder builder("town");
    const std::uint32_t wall =
        builder.add(small_scenes::parts::plain("wall", {0.6f, 0.5f, 0.4f}, 0, 1));
    const std::uint32_t ware =
        builder.add(small_scenes::parts::plain("ware", {0.2f, 0.5f, 0.8f}, 0, 1));
    const std::uint32_t block =
        builder.add("block", small_scenes::parts::box({-2, 0, -2}, {2, 8, 2}, 1), wall);
    const std::uint32_t ball = builder.add(
        "ball", small_scenes::parts::patch(small_scenes::parts::sphere(0.5), 24, 12, {1, 1}), ware);
    for (int x = -4; x <= 4; ++x)
        for (int z = -4; z <= 4; ++z)
            if ((x + z) % 3 != 0) builder.place(block, {6.0f * float(x), 0, 6.0f * float(z)});
    for (int i = 0; i < 300; ++i)
        builder.place(ball, random.vec3(-28, 28) * glm::vec3(1, 0.15f, 1) + glm::vec3(0, 2, 0),
                      random(0, 6), random(0.3f, 1.5f));
    Scene scene = std::move(builder).finish();
    scene::Animation animation{.name = "drift", .duration = 4, .channels = {}};
    for (std::uint32_t node = 60; node < scene.nodes.size(); node += 2) {
        const glm::vec4 from(scene.nodes[node].translation, 0);
        animation.channels.push_back(
            {.node = node,
             .times = {0, 2, 4},
             .values = {from, from + glm::vec4(random.vec3(-6, 6), 0), from}});
    }
    scene.animations.push_back(animation);
    return scene;
}

FrameSettings settingsOf(CullMode cull, const LodChoice& lod) {
    FrameSettings settings;
    settings.size = kSize;
    settings.shadowTaps = 0;
    settings.skyViews = 0;
    settings.cull = cull;
    settings.lod = lod;
    return settings;
}

class OcclusionTest : public GpuTest {
protected:
    /// Renders the same run of views both ways; the pictures must agree in every pixel.
    void compare(const LodChoice& lod, int views, std::uint32_t seed,
                 CaptureBackend backend = CaptureBackend::automatic, bool scales = false) {
        const Scene source = town(seed);
        scene::GpuScene onGpu(device(), source);
        FrameSettings settings = settingsOf(CullMode::frustum, lod);
        settings.capture = backend;
        Frame plain(device(), onGpu, settings);
        settings.cull = CullMode::hiz;
        Frame hidden(device(), onGpu, settings);
        small_scenes::Random random(seed + 1);
        Camera camera{.eye = {0, 2, 0}, .at = {4, 2, 1}, .verticalFov = 1.1f, .nearPlane = 0.05f};
        std::uint64_t hiddenInstances = 0, found = 0, hiddenClusters = 0;
        for (int view = 0; view < views; ++view) {
            if (view % 9 == 0) {  // a cut
                camera.eye = random.vec3(-26, 26) * glm::vec3(1, 0.2f, 1) + glm::vec3(0, 6, 0);
                camera.at = camera.eye + random.vec3(-4, 4) * glm::vec3(1, 0.3f, 1);
            } else {  // a step and a turn
                const glm::vec3 step = random.vec3(-1.5f, 1.5f);
                camera.eye += step * glm::vec3(1, 0.2f, 1);
                camera.at += step + random.vec3(-1, 1);
            }
            if (glm::distance(camera.eye, camera.at) < 0.1f) camera.at += glm::vec3(1, 0, 0);
            onGpu.animate(0.11f * float(view));
            budget::Levers levers;
            if (scales) levers.renderScale = {random(0.5f, 1), random(0.5f, 1)};
            plain.render(camera, levers);
            const auto expected = gpu::readImage(device(), plain.display());
            hidden.render(camera, levers);
            ASSERT_EQ(gpu::readImage(device(), hidden.display()), expected) << "view " << view;
            const auto counts = gpu::as<shared::CullCounts>(
                gpu::readBuffer(device(), hidden.drawList().counts, sizeof(shared::CullCounts)))[0];
            hiddenInstances += counts.instancesHidden;
            found += counts.instancesFound;
            hiddenClusters += counts.clustersHidden;
        }
        EXPECT_GT(hiddenInstances, 5u * views) << "hardly anything was hidden";
        EXPECT_GT(found, 0u) << "nothing ever appeared: the second phase was not tried";
        EXPECT_LT(found, hiddenInstances / 2);
    }
};

TEST_F(OcclusionTest, picturesAreTheSameWithAndWithoutIt) {
    compare({}, 90, 3);
}

TEST_F(OcclusionTest, picturesAreTheSameWhoeverCaptures) {
    compare({}, 27, 5, CaptureBackend::supersample);
    if (device().hasInt64Atomics()) compare({}, 27, 5, CaptureBackend::compute);
}

TEST_F(OcclusionTest, picturesAreTheSameWhateverTheirScaleAndThatOfTheOneBefore) {
    compare({}, 45, 23, CaptureBackend::supersample, true);
    if (device().hasInt64Atomics()) compare({}, 45, 23, CaptureBackend::compute, true);
}

TEST_F(OcclusionTest, picturesAreTheSameWithLevelsOfDetail) {
    compare({.mode = LodChoice::Mode::error, .errorPx = 1, .distances = {}}, 45, 17);
}

/// Takes a minute: ctest runs it by itself, as occlusion_long.
TEST_F(OcclusionTest, aThousandViewsAreTheSame) {
    for (const std::uint32_t seed : {101u, 102u, 103u, 104u, 105u}) {
        const LodChoice onePixel{.mode = LodChoice::Mode::error, .errorPx = 1, .distances = {}};
        compare({}, 100, seed, CaptureBackend::automatic, seed % 2 == 0);
        compare(onePixel, 100, seed + 50, CaptureBackend::automatic, seed % 2 == 1);
    }
}

TEST_F(OcclusionTest, aWallHidesWhatIsBehindItFromTheSecondFrameOn) {
    small_scenes::SceneBuilder builder("wall");
    const std::uint32_t material = builder.add(scene::Material{});
    builder.place(
        builder.add("wall", small_scenes::parts::box({-5, -5, -0.5}, {5, 5, 0}, 1), material));
    const std::uint32_t ball = builder.add(
        "ball", small_scenes::parts::patch(small_scenes::parts::sphere(0.5), 24, 12, {1, 1}),
        material);
    for (int i = 0; i < 50; ++i) builder.place(ball, {0.1f * float(i) - 2.5f, 0, -3.0f - float(i)});
    const Scene source = std::move(builder).finish();
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settingsOf(CullMode::hiz, {}));
    const auto hidden = [&](const Camera& camera) {
        frame.render(camera, {});
        const auto counts = gpu::as<shared::CullCounts>(
            gpu::readBuffer(device(), frame.drawList().counts, sizeof(shared::CullCounts)))[0];
        return counts.instancesHidden - counts.instancesFound;
    };
    const Camera camera{.eye = {0, 0, 8}, .at = {0, 0, 0}};
    EXPECT_EQ(hidden(camera), 0u);
    EXPECT_EQ(hidden(camera), 50u);
    EXPECT_EQ(hidden({.eye = {0, 0, -80}, .at = {0, 0, 0}}), 0u) << "a cut";
    EXPECT_EQ(hidden(camera), 0u) << "the picture before showed the other side";
    EXPECT_EQ(hidden(camera), 50u);
    frame.resetOcclusion();
    EXPECT_EQ(hidden(camera), 0u);

    // From the side: the balls, unless they were not drawn. The wall turns its back.
    const Camera aside{.eye = {-60, 0, -28}, .at = {0, 0, -28}};
    const auto covered = [&] {
        std::size_t pixels = 0;
        for (const auto id : gpu::as<std::uint32_t>(gpu::readImage(device(), frame.ids())))
            pixels += id != 0;
        return pixels;
    };
    frame.renderOutside(aside);
    const std::size_t all = covered();
    EXPECT_GT(all, 5u) << "the first frame hides nothing";
    EXPECT_EQ(hidden(camera), 0u) << "another view's picture hides nothing";
    EXPECT_EQ(hidden(camera), 50u);
    frame.renderOutside(aside);
    EXPECT_EQ(covered(), 0u);
}

TEST_F(OcclusionTest, theFrameAfterACutHidesByTheWholePictureBefore) {
    // A wall, a screen behind it, balls behind that. From before the wall nothing else is seen;
    // from behind it everything is drawn by the second phase, the screen too.
    small_scenes::SceneBuilder builder("wall and screen");
    const std::uint32_t material = builder.add(scene::Material{});
    const std::uint32_t wall =
        builder.add("wall", small_scenes::parts::box({-20, -20, -0.5}, {20, 20, 0}, 1), material);
    const std::uint32_t screen =
        builder.add("screen", small_scenes::parts::box({-4, -4, -0.5}, {4, 4, 0}, 1), material);
    builder.place(wall, {0, 0, 12});
    builder.place(screen, {0, 0, 0});
    const std::uint32_t ball = builder.add(
        "ball", small_scenes::parts::patch(small_scenes::parts::sphere(0.5), 24, 12, {1, 1}),
        material);
    for (int i = 0; i < 50; ++i) builder.place(ball, {0.1f * float(i) - 2.5f, 0, -3.0f - float(i)});
    const Scene source = std::move(builder).finish();
    const scene::GpuScene onGpu(device(), source);
    Frame frame(device(), onGpu, settingsOf(CullMode::hiz, {}));
    const auto hidden = [&](const Camera& camera) {
        frame.render(camera, {});
        const auto counts = gpu::as<shared::CullCounts>(
            gpu::readBuffer(device(), frame.drawList().counts, sizeof(shared::CullCounts)))[0];
        return counts.instancesHidden - counts.instancesFound;
    };
    const Camera outside{.eye = {0, 0, 20}, .at = {0, 0, 0}};
    const Camera behind{.eye = {0, 0, 8}, .at = {0, 0, 0}};
    hidden(outside);
    EXPECT_EQ(hidden(outside), 51u);
    EXPECT_EQ(hidden(behind), 0u);
    EXPECT_EQ(hidden(behind), 50u);
}

}  // namespace
}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/procedural.hpp>
#include <lodestar/visibility/expand.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::frame {
namespace {

using small_scenes::single;
using visibility::Record;

constexpr CaptureBackend kSs = CaptureBackend::supersample, kMs = CaptureBackend::multisample,
                         kCompute = CaptureBackend::compute;

/// A scene on the device and a view of it.
struct Subject {
    scene::Scene source;
    scene::GpuScene onGpu;
    scene::Camera camera;

    Subject(const gpu::Device& device, scene::Scene s, scene::Camera c)
        : source(std::move(s)), onGpu(device, source), camera(c) {}
    Subject(const gpu::Device& device, const std::string& builtin, std::size_t which)
        : source(*scene::buildBuiltin(builtin)),
          onGpu(device, source),
          camera(scene::fromSceneCamera(source.cameras[which],
                                        worldFromNode(source)[source.cameras[which].node], 10)) {}
};

class CaptureTest : public GpuTest {
protected:
    static Record capture(const Subject& subject, const CaptureSettings& settings) {
        CaptureFrame frame(device(), subject.onGpu, settings);
        frame.capture(subject.camera);
        return visibility::readRecord(device(), frame.compact());
    }
    static std::vector<std::uint32_t> ids(const Subject& subject, const CaptureSettings& settings) {
        return visibility::expandReference(capture(subject, settings));
    }
    /// The ids of grid O from a capture.
    static std::vector<std::uint32_t> rebuilt(const Subject& subject,
                                              const CaptureSettings& settings, vk::Extent2D size,
                                              bool representatives = false) {
        CaptureFrame frame(device(), subject.onGpu, settings);
        frame.capture(subject.camera);
        const visibility::Expand expand(device(), settings.side);
        const gpu::Image image(device(), {.name = "ids",
                                          .format = vk::Format::eR32Uint,
                                          .extent = size,
                                          .usage = vk::ImageUsageFlagBits::eStorage |
                                                   vk::ImageUsageFlagBits::eTransferSrc});
        const float aspect = float(settings.base.width) / float(settings.base.height);
        const glm::mat4 clip = subject.camera.clipFromView(aspect) * subject.camera.viewFromWorld();
        gpu::Recorder rec(device());
        rec.begin();
        if (representatives)
            expand.recordRepresentatives(rec, subject.onGpu, frame.compact(), image);
        else
            expand.record(rec, subject.onGpu, frame.compact(), clip, image);
        rec.submit();
        return gpu::as<std::uint32_t>(gpu::readImage(device(), image));
    }
    static double sameShare(const std::vector<std::uint32_t>& a,
                            const std::vector<std::uint32_t>& b) {
        EXPECT_EQ(a.size(), b.size());
        std::size_t same = 0;
        for (std::size_t i = 0; i < a.size(); ++i) same += a[i] == b[i];
        return double(same) / double(a.size());
    }
    static std::size_t covered(const std::vector<std::uint32_t>& ids) {
        return ids.size() - std::size_t(std::count(ids.begin(), ids.end(), 0u));
    }
    static void expectSameBytes(const Record& a, const Record& b) {
        ASSERT_EQ(a.heads.size(), b.heads.size());
        ASSERT_EQ(a.nodes.size(), b.nodes.size());
        EXPECT_EQ(std::memcmp(a.heads.data(), b.heads.data(), 8 * a.heads.size()), 0);
        EXPECT_EQ(std::memcmp(a.nodes.data(), b.nodes.data(), 12 * a.nodes.size()), 0);
    }
};

TEST_F(CaptureTest, everyRateHoldsTheIdsOfDirectRasterAtItsSize) {
    const Subject columns(device(), "columns", 0);
    for (const CaptureBackend backend : {kSs, kCompute}) {
        const auto direct = ids(columns, {.base = {136, 88}, .side = 1, .backend = backend});
        EXPECT_GT(covered(direct), direct.size() / 2);
        for (const std::uint32_t side : {2u, 4u, 8u})
            EXPECT_EQ(
                ids(columns, {.base = {136 / side, 88 / side}, .side = side, .backend = backend}),
                direct)
                << int(backend) << " side " << side;
    }
}

TEST_F(CaptureTest, bandsAndRunsDoNotChangeAByte) {
    const Subject columns(device(), "columns", 1);
    for (const CaptureBackend backend : {kSs, kCompute}) {
        const CaptureSettings whole{.base = {33, 21}, .side = 4, .backend = backend};
        const Record record = capture(columns, whole);
        EXPECT_GT(record.nodes.size(), 100u);
        expectSameBytes(capture(columns, whole), record);
        for (const std::uint32_t rows : {1u, 4u, 20u}) {
            CaptureSettings banded = whole;
            banded.bandRows = rows;
            expectSameBytes(capture(columns, banded), record);
        }
    }
}

TEST_F(CaptureTest, backendsAgreeButForSnapping) {
    for (const auto& [name, camera] : {std::pair{"columns", 0}, {"columns", 3}, {"spheres", 1}}) {
        SCOPED_TRACE(testing::Message() << name << " " << camera);
        const Subject subject(device(), name, std::size_t(camera));
        const auto ss = ids(subject, {.base = {24, 16}, .side = 8, .backend = kSs});
        EXPECT_GT(sameShare(ss, ids(subject, {.base = {24, 16}, .side = 8, .backend = kCompute})),
                  0.99);
        // A vertex snaps to 1/256 pixel of grid B there, 1/32 sample of C: much, where triangles
        // are as small as here.
        EXPECT_GT(sameShare(ss, ids(subject, {.base = {24, 16}, .side = 8, .backend = kMs})), 0.97);
    }
}

TEST_F(CaptureTest, multisamplePassesVisitEveryCellOnce) {
    for (const auto& [device, side] : {std::pair{4u, 4u}, {4u, 8u}, {8u, 8u}, {8u, 4u}}) {
        const auto plan = visibility::planMultisample(device, side);
        EXPECT_EQ(plan.shifts.size() * plan.samples * plan.pixels * plan.pixels, side * side);
    }
    EXPECT_TRUE(visibility::planMultisample(1, 4).shifts.empty());
    EXPECT_TRUE(visibility::planMultisample(4, 2).shifts.empty());
    if (device().multisamples() == 1) GTEST_SKIP() << "no multisampling";
    // A pixel-sized checkerboard would show a sample in the wrong cell; a slanted edge shows all.
    const Subject quad(device(), single(small_scenes::quad()), small_scenes::facing(6.7f));
    scene::Camera turned = quad.camera;
    turned.up = glm::vec3(0.3f, 1, 0);
    const Subject slanted(device(), single(small_scenes::quad()), turned);
    for (const std::uint32_t side : {4u, 8u})
        for (const Subject* subject : {&quad, &slanted}) {
            const CaptureSettings ss{.base = {13, 11}, .side = side, .backend = kSs};
            CaptureSettings ms = ss;
            ms.backend = kMs;
            EXPECT_GT(sameShare(ids(*subject, ss), ids(*subject, ms)), 0.995) << side;
            ms.bandRows = 3;
            EXPECT_GT(sameShare(ids(*subject, ss), ids(*subject, ms)), 0.995) << side;
        }
}

TEST_F(CaptureTest, trianglesOfEveryKindAgreeWithTheRasterPipeline) {
    // All four draw bins, mirrored and sheared instances.
    const Subject jumble(device(), small_scenes::jumble(),
                         {.eye = {2, 3, 9}, .at = {0, 0, 0}, .verticalFov = 0.9f});
    const CaptureSettings ss{.base = {96, 64}, .side = 1, .backend = kSs};
    CaptureSettings compute = ss;
    compute.backend = kCompute;
    const auto a = ids(jumble, ss), b = ids(jumble, compute);
    EXPECT_GT(covered(a), a.size() / 5);
    EXPECT_GT(sameShare(a, b), 0.985);
    // Inside the jumble: triangles cross the near plane and reach far beyond the picture.
    const Subject inside(device(), small_scenes::jumble(),
                         {.eye = {0.5f, 0.2f, 0.5f}, .at = {1, 0, -1}, .verticalFov = 1.4f});
    EXPECT_GT(sameShare(ids(inside, ss), ids(inside, compute)), 0.985);
}

TEST_F(CaptureTest, whereThereIsNoRoomForProjectedVerticesTheWordsAreTheSame) {
    const scene::Camera inside{.eye = {0.5f, 0.2f, 0.5f}, .at = {1, 0, -1}, .verticalFov = 1.4f};
    const Subject jumble(device(), small_scenes::jumble(), inside);
    const Subject columns(device(), "columns", 1);
    for (const Subject* subject : {&jumble, &columns}) {
        const scene::GpuScene& onGpu = subject->onGpu;
        const geometry::Cull cull(device());
        const visibility::CaptureCompute pass(device(), onGpu.features());
        const visibility::CaptureCompute::Scratch scratch(device(), 97 * 65);
        const glm::mat4 clip =
            subject->camera.clipFromView(97.0f / 65) * subject->camera.viewFromWorld();
        const geometry::SampledPicture picture{clip, {97, 65}, 0, 65};
        const auto words = [&](std::uint32_t room) {
            geometry::DrawList list(device(), onGpu, "list", scene::TablePart::eye, room);
            geometry::CullView view{
                .clipFromWorld = clip, .eye = subject->camera.eye, .size = picture.size};
            if (room > 0) view.samples = picture;
            gpu::Recorder rec(device());
            rec.begin();
            cull.record(rec, onGpu, view, list);
            rec.barrier(gpu::Stage::compute, gpu::Stage::indirect);
            rec.barrier(gpu::Stage::compute, gpu::Stage::compute);
            pass.record(rec, onGpu, list, picture, scratch, "capture");
            rec.submit();
            return gpu::as<std::uint64_t>(
                gpu::readBuffer(device(), scratch.words.buffer(), 8 * 97 * 65));
        };
        const auto none = words(0);
        EXPECT_GT(none.size() - std::size_t(std::count(none.begin(), none.end(), 0u)), 1000u);
        EXPECT_EQ(words(3), none);
        EXPECT_EQ(words(geometry::kProjectedClusters), none);
    }
}

TEST_F(CaptureTest, aFloorThroughTheNearPlaneHasNoHoles) {
    for (const float behind : {100.0f, 0.0f, -1e-3f}) {
        const Subject floor(device(),
                            single(small_scenes::triangles({{-1e4f, 0, behind},
                                                            {1e4f, 0, behind},
                                                            {1e4f, 0, -1e4f},
                                                            {-1e4f, 0, behind},
                                                            {1e4f, 0, -1e4f},
                                                            {-1e4f, 0, -1e4f}})),
                            {.eye = {0, 1.5f, 0}, .at = {0, 1.5f, -1}, .verticalFov = 1.2f});
        const std::uint32_t width = 160, height = 120;
        const auto found =
            ids(floor, {.base = {width / 4, height / 4}, .side = 4, .backend = kCompute});
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                if (y == height / 2) continue;  // the horizon itself ends somewhere
                ASSERT_EQ(found[y * width + x] != 0, y > height / 2) << x << " " << y;
            }
    }
}

TEST_F(CaptureTest, trianglesThatShareAnEdgeShareNoSampleAndLeaveNone) {
    // A fan about a point that is itself a sample centre, larger than the picture.
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 12; ++i) {
        const float a = 0.5235988f * float(i), b = 0.5235988f * float(i + 1);
        corners.insert(corners.end(), {{0, 0, 0},
                                       {3 * std::cos(a), 3 * std::sin(a), 0},
                                       {3 * std::cos(b), 3 * std::sin(b), 0}});
    }
    const Subject fan(device(), single(small_scenes::triangles(corners)), small_scenes::facing());
    const auto found = ids(fan, {.base = {35, 35}, .side = 1, .backend = kCompute});
    EXPECT_EQ(covered(found), found.size());
    EXPECT_GT(sameShare(found, ids(fan, {.base = {35, 35}, .side = 1, .backend = kSs})), 0.97);
}

TEST_F(CaptureTest, levelsOfDetailAreChosenOnceForAllBands) {
    const Subject spheres(device(), "spheres", 0);
    for (const CaptureBackend backend : {kSs, kMs, kCompute}) {
        CaptureSettings settings{.base = {48, 30}, .side = 4, .backend = backend};
        const auto finest = ids(spheres, settings);
        settings.lod = {.mode = geometry::LodChoice::Mode::error, .errorPx = 0.5f, .distances = {}};
        const Record whole = capture(spheres, settings);
        const auto coarse = visibility::expandReference(whole);
        const auto different = [](std::vector<std::uint32_t> of) {
            std::sort(of.begin(), of.end());
            return std::unique(of.begin(), of.end()) - of.begin();
        };
        EXPECT_LT(different(coarse), different(finest)) << int(backend);
        EXPECT_NEAR(double(covered(coarse)), double(covered(finest)), 0.02 * double(finest.size()));
        for (const std::uint32_t rows : {1u, 7u}) {
            settings.bandRows = rows;
            expectSameBytes(capture(spheres, settings), whole);
        }
    }
}

TEST_F(CaptureTest, aPoolThatIsTooSmallIsFoundAndGrown) {
    const Subject columns(device(), "columns", 0);
    CaptureSettings settings{.base = {40, 24}, .side = 8, .backend = kCompute};
    const Record expected = capture(columns, settings);
    settings.words = 7;
    CaptureFrame frame(device(), columns.onGpu, settings);
    const CaptureFrame::Done done = frame.capture(columns.camera);
    EXPECT_EQ(done.recaptured, 7u);
    expectSameBytes(visibility::readRecord(device(), frame.compact()), expected);
    EXPECT_EQ(frame.capture(columns.camera).recaptured, 0u);
}

TEST_F(CaptureTest, bandsKeepTransientMemoryBounded) {
    const Subject quad(device(), single(small_scenes::quad()), small_scenes::facing());
    for (const CaptureBackend backend : {kSs, kMs, kCompute}) {
        CaptureFrame frame(
            device(), quad.onGpu,
            {.base = {256, 256}, .side = 8, .backend = backend, .transientBytes = 12 << 20});
        EXPECT_GT(frame.bands(), 2u);
        EXPECT_LE(frame.transientBytes(), 12u << 20) << int(backend);
    }
}

TEST_F(CaptureTest, rebuildingAtTheCaptureRateGivesTheIdsOfDirectRaster) {
    const Subject columns(device(), "columns", 0);
    for (const CaptureBackend backend : {kSs, kCompute}) {
        const auto direct = ids(columns, {.base = {136, 88}, .side = 1, .backend = backend});
        for (const std::uint32_t side : {1u, 2u, 4u, 8u}) {
            const CaptureSettings settings{
                .base = {136 / side, 88 / side}, .side = side, .backend = backend};
            EXPECT_EQ(rebuilt(columns, settings, {136, 88}), direct) << side;
        }
    }
    // A third of the rate: centres still lie on samples.
    const auto third =
        rebuilt(columns, {.base = {33, 24}, .side = 8, .backend = kCompute}, {88, 64});
    const auto direct = ids(columns, {.base = {88, 64}, .side = 1, .backend = kCompute});
    EXPECT_GT(sameShare(third, direct), 0.985);  // vertices snap to a finer grid there
}

TEST_F(CaptureTest, rebuildingElsewhereComesCloseToDirectRaster) {
    // Triangles that are mostly larger than a sample: one that no sample saw cannot come back.
    small_scenes::Random random(5);
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 60; ++i) {
        const glm::vec3 centre = random.vec3(-1, 1);
        for (int k = 0; k < 3; ++k) corners.push_back(centre + random.vec3(-0.5f, 0.5f));
    }
    scene::Material material;
    material.doubleSided = true;
    const Subject soup(device(), single(small_scenes::triangles(corners), material),
                       {.eye = {0.3f, 0.4f, 3}, .at = {0, 0, 0}});
    const CaptureSettings settings{.base = {60, 40}, .side = 4, .backend = kCompute};
    const auto grid = visibility::expandReference(capture(soup, settings));
    EXPECT_GT(covered(grid), grid.size() / 3);
    for (const vk::Extent2D size :
         {vk::Extent2D{30, 20}, {60, 40}, {120, 80}, {171, 114}, {480, 320}, {720, 480}}) {
        SCOPED_TRACE(size.width);
        const auto expected = ids(soup, {.base = size, .side = 1, .backend = kCompute});
        std::vector<std::uint32_t> nearest;  // what there would be without edge tests
        for (std::uint32_t y = 0; y < size.height; ++y)
            for (std::uint32_t x = 0; x < size.width; ++x)
                nearest.push_back(grid[(2 * y + 1) * 160 / (2 * size.height) * 240 +
                                       (2 * x + 1) * 240 / (2 * size.width)]);
        const double wrong = 1 - sameShare(rebuilt(soup, settings, size), expected);
        EXPECT_LT(wrong, 0.005);
        EXPECT_LT(wrong, 0.2 * (1 - sameShare(nearest, expected)));
    }
}

TEST_F(CaptureTest, representativesAreTheHeads) {
    const Subject columns(device(), "columns", 1);
    const CaptureSettings settings{.base = {31, 17}, .side = 8, .backend = kCompute};
    const Record record = capture(columns, settings);
    std::vector<std::uint32_t> heads;
    for (const auto& head : record.heads) heads.push_back(head.id);
    EXPECT_EQ(rebuilt(columns, settings, {31, 17}, true), heads);
}

TEST_F(CaptureTest, theAutomaticBackendFollowsTheSizeOfTriangles) {
    if (!device().hasInt64Atomics()) GTEST_SKIP() << "no choice";
    const CaptureSettings settings{.base = {64, 64}, .side = 4};
    const Subject quad(device(), single(small_scenes::quad()), small_scenes::facing());
    const bool cpu = device().description().type == "Cpu";  // on a GPU it is always compute
    EXPECT_EQ(chooseBackend(device(), quad.onGpu, settings, quad.camera), cpu ? kSs : kCompute);
    const Subject spheres(device(), "spheres", 0);  // 99,744 triangles
    EXPECT_EQ(chooseBackend(device(), spheres.onGpu, settings, spheres.camera), kCompute);
    scene::Camera away = spheres.camera;
    away.at = 2.0f * away.eye - away.at;  // none of them in view
    EXPECT_EQ(chooseBackend(device(), spheres.onGpu, settings, away), cpu ? kSs : kCompute);
}

TEST_F(CaptureTest, refusesSizesItCannotHold) {
    const Subject quad(device(), single(small_scenes::quad()), small_scenes::facing());
    EXPECT_THROW(CaptureFrame(device(), quad.onGpu, {.base = {4096, 16}, .side = 8}),
                 std::invalid_argument);
    EXPECT_THROW(CaptureFrame(device(), quad.onGpu, {.base = {16, 16}, .side = 3}),
                 std::invalid_argument);
    EXPECT_THROW(CaptureFrame(device(), quad.onGpu, {.base = {0, 16}}), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::frame

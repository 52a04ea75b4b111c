// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>

#include <lodestar/geometry/cull_params.h>
#include <lodestar/geometry/cull.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/procedural.hpp>
#include <lodestar/visibility/capture_ss.hpp>
#include <lodestar/visibility/rebuild_reference.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::geometry {
namespace {

using gpu::Stage;
using scene::Camera;
using scene::Scene;
using shared::GpuCluster;
using shared::GpuTriangle;

/// The draw list of one view, read back.
struct Drawn {
    std::uint32_t clusters = 0;  // that were looked into
    std::vector<std::uint32_t> ids;
    std::vector<vk::DrawIndirectCommand> draws;
    std::vector<GpuCluster> table;  // what the ids name, with the unused one at 0

    bool operator==(const Drawn& other) const {
        return clusters == other.clusters && ids == other.ids && draws == other.draws;
    }
    const GpuCluster& clusterOf(std::uint32_t id) const {
        return table.at(id >> shared::LS_TRIANGLE_BITS);
    }
    /// Instance, meshlet and triangle: what an id stands for, whichever view was culled.
    using Key = std::array<std::uint32_t, 3>;
    Key key(std::uint32_t id) const {
        const GpuCluster& c = clusterOf(id);
        return {c.instance, c.meshlet, id & shared::LS_TRIANGLE_MASK};
    }
    std::set<Key> keys() const {
        std::set<Key> all;
        for (const std::uint32_t id : ids) all.insert(key(id));
        return all;
    }
};

/// A scene on the device and, of its records, what the CPU's checks need.
struct Fixture {
    scene::Scene source;
    scene::GpuScene onGpu;
    Cull cull;
    DrawList list;
    gpu::Recorder rec;
    std::vector<GpuTriangle> triangles;
    std::vector<shared::GpuVertex> vertices;
    std::vector<glm::dmat4> worldFromObject;

    /// Without levels of detail: only the meshes themselves are listed.
    Fixture(const gpu::Device& device, scene::Scene scene, bool simplify = false)
        : source(std::move(scene)),
          onGpu(device, source, {}, {.simplify = simplify}),
          cull(device),
          list(device, onGpu, "list"),
          rec(device),
          triangles(records<GpuTriangle>(onGpu.triangles)),
          vertices(records<shared::GpuVertex>(onGpu.vertices)) {
        const auto worldFromNodes = worldFromNode(source);
        for (const scene::Instance& i : source.instances)
            worldFromObject.emplace_back(worldFromNodes[i.node] * i.nodeFromObject);
    }

    template <typename T>
    std::vector<T> records(const gpu::TexelBuffer& buffer) {
        return gpu::as<T>(gpu::readBuffer(rec.device(), buffer.buffer(), buffer.buffer().bytes()));
    }
    std::vector<std::uint32_t> words(const gpu::Buffer& buffer, std::size_t count) {
        return gpu::as<std::uint32_t>(gpu::readBuffer(rec.device(), buffer, 4 * count));
    }

    /// What the buffers held before must not matter.
    Drawn run(const CullView& view, std::uint32_t before = 0xdeadbeef) {
        rec.begin();
        for (const gpu::Buffer* b :
             {&list.ids.buffer(), &list.draws, &list.counts, &list.chunkOffsets, &list.chunks,
              &list.firstOffsets.buffer(), &list.states, &list.candidates, &list.candidateOffsets,
              &list.hidden, &list.masks, &list.triangleOffsets})
            rec.fill(*b, before);
        rec.barrier(Stage::transfer, Stage::compute);
        rec.barrier(Stage::transfer, Stage::transfer);
        cull.record(rec, onGpu, view, list);
        rec.submit();
        return read();
    }

    shared::CullCounts counts() {
        return gpu::as<shared::CullCounts>(
                   gpu::readBuffer(rec.device(), list.counts, sizeof(shared::CullCounts)))
            .front();
    }

    Drawn read() {
        Drawn drawn;
        const shared::CullCounts found = counts();
        drawn.clusters = found.lists[shared::LS_LIST_CLUSTERS].count +
                         found.lists[shared::LS_LIST_CLUSTERS_2].count;
        drawn.draws = gpu::as<vk::DrawIndirectCommand>(
            gpu::readBuffer(rec.device(), list.draws, list.draws.bytes()));
        std::size_t indexCount = 0;
        for (const auto& draw : drawn.draws) indexCount += draw.vertexCount;
        EXPECT_LE(indexCount, 3u * onGpu.triangleCount());
        EXPECT_EQ(indexCount % 3, 0u);
        if (indexCount > 0 && indexCount <= 3u * onGpu.triangleCount())
            drawn.ids = words(list.ids.buffer(), indexCount / 3);
        // The unused one, then those of the view.
        const auto all = gpu::as<GpuCluster>(
            gpu::readBuffer(rec.device(), onGpu.clusters.buffer(),
                            sizeof(GpuCluster) * (list.table + drawn.clusters)));
        drawn.table.assign(all.begin() + (list.table - 1), all.end());
        for (std::uint32_t& id : drawn.ids)
            id -= (list.table - 1) << shared::LS_TRIANGLE_BITS;  // as if the part began at 1
        return drawn;
    }

    glm::dvec3 corner(const GpuCluster& cluster, std::uint32_t vertex) const {
        return worldFromObject[cluster.instance] * glm::dvec4(vertices[vertex].position, 1);
    }
    std::array<glm::dvec3, 3> world(const GpuCluster& cluster, std::uint32_t triangle) const {
        const GpuTriangle& t = triangles[cluster.triangles + triangle];
        return {corner(cluster, t.a), corner(cluster, t.b), corner(cluster, t.c)};
    }
    bool doubleSided(const GpuCluster& cluster) const {
        return source.materials[cluster.material].doubleSided;
    }
    /// Every cluster of the scene, as no culling lists them.
    std::vector<GpuCluster> everyCluster() {
        CullView view{.size = {64, 64}, .cull = CullMode::none};
        std::vector<GpuCluster> all = run(view).table;
        all.erase(all.begin());
        return all;
    }
};

/// A view that has everything in it, every triangle over many pixels: orthographic.
CullView wholeScene(const scene::Bounds& bounds) {
    const float r = 1 / (2 * bounds.radius());
    glm::mat4 clip = glm::scale(glm::mat4(1), {r, r, r / 2});
    clip = glm::translate(clip, -bounds.centre());
    clip[3][2] += 0.5f;
    return {.clipFromWorld = clip, .size = {1 << 20, 1 << 20}, .perspective = false};
}

constexpr vk::Extent2D kSize{48, 32};

CullView viewOf(const Camera& camera) {
    return {.clipFromWorld = camera.clipFromView(1.5f) * camera.viewFromWorld(),
            .eye = camera.eye,
            .size = kSize};
}

/// The jumble, with every material double-sided.
Scene twoSidedJumble() {
    Scene scene = small_scenes::jumble();
    for (scene::Material& m : scene.materials) m.doubleSided = true;
    return scene;
}

Camera randomCamera(small_scenes::Random& random) {
    Camera camera;
    camera.eye = random.vec3(-6, 6);
    camera.at = random.vec3(-4, 4);
    camera.verticalFov = random(0.2f, 1.8f);
    camera.nearPlane = random(0.01f, 1.0f);
    return camera;
}

glm::dvec3 crossOf(const std::array<glm::dvec3, 3>& t) {
    return glm::cross(t[1] - t[0], t[2] - t[0]);
}

class CullTest : public GpuTest {};

TEST_F(CullTest, drawsEveryTriangleOnceInClusterOrderWhereAllIsVisible) {
    Fixture f(device(), twoSidedJumble());
    const Drawn drawn = f.run(wholeScene(f.onGpu.bounds()));
    EXPECT_EQ(drawn.clusters, f.onGpu.clusterCount());
    std::vector<std::uint32_t> expected;
    for (std::uint32_t c = 1; c <= f.onGpu.clusterCount(); ++c)
        for (std::uint32_t t = 0; t < drawn.table[c].triangleCount; ++t)
            expected.push_back(c << shared::LS_TRIANGLE_BITS | t);
    EXPECT_EQ(expected.size(), countTriangles(f.source).drawn);
    // In order, each once; all but the few that this view happens to see edge-on.
    EXPECT_EQ(std::adjacent_find(drawn.ids.begin(), drawn.ids.end(), std::greater_equal<>()),
              drawn.ids.end());
    EXPECT_TRUE(
        std::includes(expected.begin(), expected.end(), drawn.ids.begin(), drawn.ids.end()));
    EXPECT_GT(drawn.ids.size(), expected.size() * 999 / 1000);
}

TEST_F(CullTest, drawsOneRangeForEachBin) {
    Fixture f(device(), small_scenes::jumble());
    const Drawn drawn = f.run(wholeScene(f.onGpu.bounds()));
    std::uint32_t next = 0;
    for (std::size_t bin = 0; bin < scene::kDrawBins; ++bin) {
        const auto& draw = drawn.draws[bin];
        EXPECT_EQ(draw.firstVertex, next);
        EXPECT_EQ(draw.instanceCount, 1u);
        EXPECT_EQ(draw.firstInstance, 0u);
        EXPECT_GT(draw.vertexCount, 0u);
        for (std::uint32_t i = next / 3; i < (next + draw.vertexCount) / 3; ++i) {
            const std::uint32_t material = drawn.clusterOf(drawn.ids[i]).material;
            const bool masked = f.source.materials[material].alphaMode != scene::AlphaMode::opaque;
            ASSERT_EQ(bin, 2u * masked + f.source.materials[material].doubleSided);
        }
        next += draw.vertexCount;
    }
    EXPECT_EQ(next, 3 * drawn.ids.size());
}

TEST_F(CullTest, drawsNothingWhereTheCameraLooksAway) {
    Fixture f(device(), small_scenes::jumble());
    const Camera away{.eye = {0, 0, 12}, .at = {0, 0, 20}};
    const Drawn drawn = f.run(viewOf(away));
    EXPECT_TRUE(drawn.ids.empty());
    for (const auto& draw : drawn.draws) EXPECT_EQ(draw.vertexCount, 0u);
}

TEST_F(CullTest, keepsWhatLiesBeforeTheNearPlaneWhereAsked) {
    Fixture f(device(), twoSidedJumble());
    CullView view = wholeScene(f.onGpu.bounds());
    view.clipFromWorld[3][2] += 0.5f;  // the near plane (depth 1) cuts the scene
    EXPECT_LT(f.run(view).ids.size(), f.onGpu.triangleCount() * 3 / 4);
    view.keepBeforeNear = true;
    EXPECT_GT(f.run(view).ids.size(), f.onGpu.triangleCount() * 999ull / 1000);
}

/// Whether the triangle covers the centre of a pixel of kSize, beyond what rounding could change.
/// `front` = seen from the side from which it is counter-clockwise.
struct Coverage {
    bool any = false, front = false;
};
Coverage coverageOf(const std::array<glm::dvec3, 3>& world, const glm::dmat4& clipFromWorld,
                    glm::dvec3 eye) {
    std::array<glm::dvec4, 3> clip;
    int outside[4] = {}, behind = 0;
    for (int i = 0; i < 3; ++i) {
        clip[i] = clipFromWorld * glm::dvec4(world[i], 1);
        outside[0] += clip[i].x > clip[i].w;
        outside[1] += clip[i].x < -clip[i].w;
        outside[2] += clip[i].y > clip[i].w;
        outside[3] += clip[i].y < -clip[i].w;
        behind += clip[i].z >= clip[i].w;  // before the near plane
    }
    if (behind == 3 || std::count(std::begin(outside), std::end(outside), 3) > 0) return {};
    const glm::dvec2 size(kSize.width, kSize.height);
    glm::dvec2 low(0), high = size - 1.0;
    if (behind == 0) {
        low = glm::dvec2(1e9), high = glm::dvec2(-1e9);
        for (const glm::dvec4& c : clip) {
            const glm::dvec2 pixel = (glm::dvec2(c) / c.w * 0.5 + 0.5) * size - 0.5;
            low = glm::min(low, pixel);
            high = glm::max(high, pixel);
        }
        low = glm::max(glm::ceil(low), 0.0);
        high = glm::min(glm::floor(high), size - 1.0);
    }
    Coverage coverage;
    for (double y = low.y; y <= high.y; ++y)
        for (double x = low.x; x <= high.x; ++x) {
            const auto w =
                visibility::reference::weightsAt(clip, (glm::dvec2(x, y) + 0.5) / size * 2.0 - 1.0);
            const double least = std::min({w.at.x, w.at.y, w.at.z});
            if (least > 1e-4 && w.depth > 0 && w.depth < 1e6) coverage.any = true;
        }
    const glm::dvec3 normal = crossOf(world), toEye = eye - world[0];
    coverage.front =
        coverage.any && glm::dot(normal, toEye) > 1e-4 * glm::length(normal) * glm::length(toEye);
    return coverage;
}

TEST_F(CullTest, neverDropsATriangleThatCoversAPixel) {
    Fixture f(device(), small_scenes::jumble());
    const std::vector<GpuCluster> all = f.everyCluster();
    small_scenes::Random random(3);
    std::size_t drawn = 0, clusters = 0, covering = 0;
    for (int view = 0; view < 50; ++view) {
        const Camera camera = randomCamera(random);
        const Drawn list = f.run(viewOf(camera));
        ASSERT_TRUE(std::is_sorted(list.ids.begin(), list.ids.end()));
        drawn += list.ids.size();
        clusters += list.clusters;
        const glm::dmat4 clipFromWorld(viewOf(camera).clipFromWorld);
        const auto keys = list.keys();
        for (const GpuCluster& cluster : all) {
            const bool reflected =
                glm::determinant(glm::dmat3(f.worldFromObject[cluster.instance])) < 0;
            for (std::uint32_t t = 0; t < cluster.triangleCount; ++t) {
                auto corners = f.world(cluster, t);
                if (reflected) std::swap(corners[1], corners[2]);
                const Coverage coverage = coverageOf(corners, clipFromWorld, camera.eye);
                if (!(f.doubleSided(cluster) ? coverage.any : coverage.front)) continue;
                ++covering;
                ASSERT_TRUE(keys.contains({cluster.instance, cluster.meshlet, t}))
                    << "view " << view << " instance " << cluster.instance << " meshlet "
                    << cluster.meshlet << " triangle " << t;
            }
        }
    }
    EXPECT_GT(covering, 5000u);
    EXPECT_LT(drawn, 50ull * f.onGpu.triangleCount() / 5) << "hardly any triangle was culled";
    EXPECT_LT(clusters, 50 * f.onGpu.clusterCount() / 2) << "hardly any cluster was culled";
}

TEST_F(CullTest, normalConesDropClustersOfTheFarSideOfASphere) {
    Fixture f(device(), small_scenes::single(small_scenes::parts::patch(
                            small_scenes::parts::sphere(1), 96, 48, {1, 1})));
    CullView view = viewOf({.eye = {0, 0, 30}, .at = {0, 0, 0}});
    view.size = vk::Extent2D{16384, 16384};
    const Drawn withCones = f.run(view);
    view.perspective = false;
    const Drawn withoutCones = f.run(view);
    EXPECT_EQ(withoutCones.clusters, f.onGpu.clusterCount());
    EXPECT_LT(withCones.clusters, withoutCones.clusters * 3 / 4);
    // The triangles that remain are the same: those of the near side.
    const auto with = withCones.keys(), without = withoutCones.keys();
    EXPECT_TRUE(std::includes(without.begin(), without.end(), with.begin(), with.end()));
    EXPECT_GT(withCones.ids.size(), withoutCones.ids.size() * 98 / 100);
    EXPECT_NEAR(double(withCones.ids.size()) / f.onGpu.triangleCount(), 0.5, 0.05);
}

TEST_F(CullTest, sameViewGivesTheSameBytes) {
    Fixture f(device(), *scene::buildBuiltin("grid:20000"));
    const Camera camera = scene::frame(f.onGpu.bounds(), 1.5f);
    const Drawn first = f.run(viewOf(camera), 0);
    EXPECT_GT(first.ids.size(), 500u);
    EXPECT_EQ(f.run(viewOf(camera), 0xffffffff), first);
}

TEST_F(CullTest, withoutCullingEveryTriangleIsListedWhereverTheCameraLooks) {
    Fixture f(device(), small_scenes::jumble());
    CullView view = viewOf({.eye = {0, 0, 12}, .at = {0, 0, 20}});
    view.cull = CullMode::none;
    const Drawn drawn = f.run(view);
    EXPECT_EQ(drawn.ids.size(), f.onGpu.triangleCount());
    EXPECT_EQ(drawn.keys().size(), f.onGpu.triangleCount());
    EXPECT_EQ(f.counts().instances, f.source.instances.size());
}

/// A row of balls that goes away from the camera of ballsView().
Scene balls(int count) {
    Scene scene = small_scenes::single(
        small_scenes::parts::patch(small_scenes::parts::sphere(0.5), 48, 24, {1, 1}));
    scene.instances.clear();
    for (int i = 0; i < count; ++i)
        small_scenes::place(
            scene, 0, glm::translate(glm::mat4(1), {0.6f * float(i % 3), 0, -4.0f * float(i)}));
    return scene;
}

TEST_F(CullTest, anInstanceIsDrawnAtTheCoarsestLevelWhoseErrorTheViewAllows) {
    Fixture f(device(), balls(200), true);
    ASSERT_GE(f.onGpu.lodCount(), 4u);
    const auto lods = f.records<shared::GpuLod>(f.onGpu.lods);
    for (const float allowed : {0.25f, 1.0f, 4.0f}) {
        CullView view = viewOf({.eye = {0, 2, 6}, .at = {0, 0, -10}});
        view.size = vk::Extent2D{1920, 1280};
        view.lod = {.mode = LodChoice::Mode::error, .errorPx = allowed, .distances = {}};
        const Drawn drawn = f.run(view);
        std::map<std::uint32_t, std::uint32_t> levels;
        for (std::size_t c = 1; c < drawn.table.size(); ++c) {
            const auto [known, fresh] =
                levels.try_emplace(drawn.table[c].instance, drawn.table[c].lod);
            EXPECT_EQ(known->second, drawn.table[c].lod) << "an instance at two levels";
        }
        EXPECT_GT(levels.size(), 100u);
        const double perUnit = double(view.clipFromWorld[1][1]) * 640;
        for (const auto& [instance, lod] : levels) {
            const double apart =
                glm::distance(glm::dvec3(f.worldFromObject[instance][3]), glm::dvec3(view.eye));
            const auto px = [&](std::uint32_t level) {
                return lods[level].error * std::abs(perUnit) / (apart - 0.5);
            };
            // The scale of an instance is taken a hundredth too large, to be on the safe side.
            EXPECT_LE(px(lod), allowed * 1.001) << "instance " << instance;
            if (lod + 1 < f.onGpu.lodCount()) {
                EXPECT_GT(px(lod + 1), allowed * 0.97) << "instance " << instance;
            }
        }
    }
}

TEST_F(CullTest, distancesGiveTheLevelsTheyName) {
    Fixture f(device(), balls(60), true);
    CullView view = viewOf({.eye = {0, 2, 6}, .at = {0, 0, -10}});
    view.lod = {.mode = LodChoice::Mode::distance, .errorPx = 1, .distances = {20, 50}};
    const Drawn drawn = f.run(view);
    std::set<std::uint32_t> seen;
    for (std::size_t c = 1; c < drawn.table.size(); ++c) {
        const double apart = glm::distance(
            glm::dvec3(f.worldFromObject[drawn.table[c].instance][3]), glm::dvec3(view.eye));
        EXPECT_EQ(drawn.table[c].lod, apart < 20 ? 0u : apart < 50 ? 1u : 2u) << apart;
        seen.insert(drawn.table[c].lod);
    }
    EXPECT_EQ(seen.size(), 3u);
}

TEST_F(CullTest, choicesThatMeanNothingAreRefused) {
    Fixture f(device(), balls(1));
    CullView view = viewOf({});
    view.lod = {.mode = LodChoice::Mode::error, .errorPx = 0, .distances = {}};
    EXPECT_THROW(f.run(view), std::invalid_argument);
    view.lod = {
        .mode = LodChoice::Mode::distance, .errorPx = 1, .distances = std::vector<float>(9, 1.0f)};
    EXPECT_THROW(f.run(view), std::invalid_argument);
    view.lod = {};
    view.cull = CullMode::hiz;
    EXPECT_THROW(f.run(view), std::invalid_argument);
}

TEST_F(CullTest, aHiZTexelIsTheFarthestOfAllPixelsBelowItAndOfNoOthers) {
    for (const vk::Extent2D size : {vk::Extent2D{1, 1}, {17, 33}, {64, 64}, {61, 7}}) {
        // A depth buffer with a slope in it, drawn.
        Fixture f(device(), twoSidedJumble());
        using Usage = vk::ImageUsageFlagBits;
        const gpu::Image depth(device(), {.name = "depth",
                                          .format = vk::Format::eD32Sfloat,
                                          .extent = size,
                                          .usage = Usage::eSampled | Usage::eTransferSrc |
                                                   Usage::eDepthStencilAttachment});
        const visibility::CaptureSs capture(device(), f.onGpu.features(),
                                            visibility::CaptureSs::Writes::depthOnly);
        CullView view = wholeScene(f.onGpu.bounds());
        view.size = size;
        HiZ hiz(device(), size, "hi-z");
        f.rec.begin();
        f.cull.record(f.rec, f.onGpu, view, f.list);
        f.rec.barrier(Stage::compute, Stage::raster);
        f.rec.barrier(Stage::compute, Stage::indirect);
        capture.record(f.rec, f.onGpu, f.list, view.clipFromWorld, {{}, depth}, "depth");
        f.rec.barrier(Stage::raster, Stage::compute);
        hiz.record(f.rec, depth, view.clipFromWorld);
        f.rec.submit();
        const auto pixels = gpu::as<float>(gpu::readImage(device(), depth));
        const auto texels = f.records<float>(hiz.pyramid());
        std::uint32_t texel = 1u << shared::LS_HIZ_FIRST;
        for (const HiZ::Level& level : hiz.levels()) {
            for (std::uint32_t y = 0; y < level.height; ++y)
                for (std::uint32_t x = 0; x < level.width; ++x) {
                    float least = 2;
                    for (std::uint32_t v = y * texel; v < std::min((y + 1) * texel, size.height);
                         ++v)
                        for (std::uint32_t u = x * texel; u < std::min((x + 1) * texel, size.width);
                             ++u)
                            least = std::min(least, pixels[v * size.width + u]);
                    ASSERT_EQ(texels[level.offset + y * level.width + x], least)
                        << size.width << "x" << size.height << " texel " << texel;
                }
            texel *= 2;
        }
        EXPECT_EQ(hiz.levels().back().width * hiz.levels().back().height, 1u);
    }
}

TEST_F(CullTest, aSceneWithoutMeshesDrawsNothing) {
    Fixture f(device(), {});
    const Drawn drawn = f.run(viewOf({}));
    EXPECT_TRUE(drawn.ids.empty());
    for (const auto& draw : drawn.draws) EXPECT_EQ(draw.vertexCount, 0u);
}

}  // namespace
}  // namespace lodestar::geometry

// SPDX-License-Identifier: Apache-2.0
#include <numeric>
#include <set>

#include <lodestar/geometry/cull.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/procedural.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::geometry {
namespace {

using gpu::Stage;
using scene::Camera;
using shared::GpuCluster;
using shared::GpuTriangle;

/// The draw list of one view, read back.
struct Drawn {
    std::vector<std::uint32_t> offsets, indices, ids;
    std::vector<vk::DrawIndexedIndirectCommand> draws;

    bool operator==(const Drawn&) const = default;
    std::set<std::uint32_t> clusters() const {
        std::set<std::uint32_t> found;
        for (const std::uint32_t id : ids) found.insert(id >> shared::LS_TRIANGLE_BITS);
        return found;
    }
};

/// A scene on the device and, of its records, what the CPU's checks need.
struct Fixture {
    scene::Scene source;
    scene::GpuScene onGpu;
    Cull cull;
    DrawList list;
    gpu::Recorder rec;
    std::vector<GpuCluster> clusters;
    std::vector<GpuTriangle> triangles;
    std::vector<shared::GpuVertex> vertices;
    std::vector<std::uint32_t> meshletVertices;
    std::vector<glm::dmat4> worldFromObject;

    Fixture(const gpu::Device& device, scene::Scene scene)
        : source(std::move(scene)),
          onGpu(device, source),
          cull(device),
          list(device, onGpu, "list"),
          rec(device),
          clusters(records<GpuCluster>(onGpu.clusters)),
          triangles(records<GpuTriangle>(onGpu.triangles)),
          vertices(records<shared::GpuVertex>(onGpu.vertices)),
          meshletVertices(records<std::uint32_t>(onGpu.meshletVertices)) {
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
        for (const gpu::Buffer* b : {&list.offsets, &list.indices, &list.ids.buffer(), &list.draws})
            rec.fill(*b, before);
        rec.barrier(Stage::transfer, Stage::compute);
        cull.record(rec, onGpu, view, list);
        rec.submit();
        Drawn drawn;
        drawn.offsets = words(list.offsets, onGpu.clusterCount() + 1);
        const std::size_t total = drawn.offsets.back();
        EXPECT_LE(total, onGpu.triangleCount());
        if (total > 0) {
            drawn.indices = words(list.indices, 3 * total);
            drawn.ids = words(list.ids.buffer(), total);
        }
        drawn.draws = gpu::as<vk::DrawIndexedIndirectCommand>(
            gpu::readBuffer(rec.device(), list.draws, list.draws.bytes()));
        return drawn;
    }

    glm::dvec3 corner(std::uint32_t cluster, std::uint32_t vertex) const {
        return worldFromObject[clusters[cluster].instance] *
               glm::dvec4(vertices[vertex].position, 1);
    }
    std::array<glm::dvec3, 3> world(std::uint32_t cluster, std::uint32_t triangle) const {
        const GpuTriangle& t = triangles[clusters[cluster].triangles + triangle];
        return {corner(cluster, t.a), corner(cluster, t.b), corner(cluster, t.c)};
    }
    bool doubleSided(std::uint32_t cluster) const {
        return source.materials[clusters[cluster].material].doubleSided;
    }
};

/// A view that keeps everything: orthographic, about all of the world box.
CullView wholeScene(const scene::Bounds& bounds) {
    const float r = 1 / (2 * bounds.radius());
    glm::mat4 clip = glm::scale(glm::mat4(1), {r, r, r / 2});
    clip = glm::translate(clip, -bounds.centre());
    clip[3][2] += 0.5f;
    return {.clipFromWorld = clip, .perspective = false};
}

CullView viewOf(const Camera& camera, bool cones = true) {
    return {.clipFromWorld = camera.clipFromView(1.5f) * camera.viewFromWorld(),
            .eye = camera.eye,
            .perspective = cones};
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
    Fixture f(device(), small_scenes::jumble());
    const Drawn drawn = f.run(wholeScene(f.onGpu.bounds()));
    std::vector<std::uint32_t> expected;
    for (std::uint32_t c = 1; c < f.onGpu.clusterCount(); ++c)
        for (std::uint32_t t = 0; t < f.clusters[c].triangleCount; ++t)
            expected.push_back(c << shared::LS_TRIANGLE_BITS | t);
    EXPECT_EQ(expected.size(), countTriangles(f.source).drawn);
    EXPECT_EQ(drawn.ids, expected);
}

TEST_F(CullTest, drawsOneRangeForEachBin) {
    Fixture f(device(), small_scenes::jumble());
    const Drawn drawn = f.run(wholeScene(f.onGpu.bounds()));
    std::uint32_t next = 0;
    for (std::size_t bin = 0; bin < scene::kDrawBins; ++bin) {
        const auto& draw = drawn.draws[bin];
        EXPECT_EQ(draw.firstIndex, next);
        EXPECT_EQ(draw.instanceCount, 1u);
        EXPECT_EQ(draw.vertexOffset, 0);
        EXPECT_EQ(draw.firstInstance, 0u);
        EXPECT_GT(draw.indexCount, 0u);
        for (std::uint32_t i = next / 3; i < (next + draw.indexCount) / 3; ++i) {
            const std::uint32_t material =
                f.clusters[drawn.ids[i] >> shared::LS_TRIANGLE_BITS].material;
            const bool masked = f.source.materials[material].alphaMode != scene::AlphaMode::opaque;
            ASSERT_EQ(bin, 2u * masked + f.source.materials[material].doubleSided);
        }
        next += draw.indexCount;
    }
    EXPECT_EQ(next, drawn.indices.size());
}

TEST_F(CullTest, indicesNameTheTrianglesCornersCounterClockwiseFromOutside) {
    Fixture f(device(), small_scenes::jumble());
    const Drawn drawn = f.run(wholeScene(f.onGpu.bounds()));
    int reflected = 0;
    for (std::size_t i = 0; i < drawn.ids.size(); ++i) {
        const std::uint32_t cluster = drawn.ids[i] >> shared::LS_TRIANGLE_BITS;
        const std::uint32_t triangle = drawn.ids[i] & shared::LS_TRIANGLE_MASK;
        std::array<glm::dvec3, 3> corners;
        std::array<std::uint32_t, 3> named{};
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t index = drawn.indices[3 * i + std::size_t(k)];
            ASSERT_EQ(index >> shared::LS_VERTEX_BITS, cluster);
            named[k] =
                f.meshletVertices[f.clusters[cluster].vertices + (index & shared::LS_VERTEX_MASK)];
            corners[k] = f.corner(cluster, named[k]);
        }
        const GpuTriangle& t = f.triangles[f.clusters[cluster].triangles + triangle];
        ASSERT_EQ(std::set({named[0], named[1], named[2]}), std::set({t.a, t.b, t.c}));

        const std::array<glm::dvec3, 3> object{f.vertices[t.a].position, f.vertices[t.b].position,
                                               f.vertices[t.c].position};
        const glm::dmat3 linear(f.worldFromObject[f.clusters[cluster].instance]);
        const glm::dvec3 outward = glm::transpose(glm::inverse(linear)) * crossOf(object);
        ASSERT_GT(glm::dot(crossOf(corners), outward), 0) << "triangle " << i;
        reflected += glm::determinant(linear) < 0;
    }
    EXPECT_GT(reflected, 1000);
}

TEST_F(CullTest, drawsNothingWhereTheCameraLooksAway) {
    Fixture f(device(), small_scenes::jumble());
    const Camera away{.eye = {0, 0, 12}, .at = {0, 0, 20}};
    const Drawn drawn = f.run(viewOf(away));
    EXPECT_TRUE(drawn.ids.empty());
    for (const auto& draw : drawn.draws) EXPECT_EQ(draw.indexCount, 0u);
}

TEST_F(CullTest, keepsWhatLiesBeforeTheNearPlaneWhereAsked) {
    Fixture f(device(), small_scenes::jumble());
    CullView view = wholeScene(f.onGpu.bounds());
    view.clipFromWorld[3][2] += 0.5f;  // the near plane (depth 1) cuts the scene
    const std::size_t cut = f.run(view).ids.size();
    view.keepBeforeNear = true;
    EXPECT_LT(cut, f.onGpu.triangleCount());
    EXPECT_EQ(f.run(view).ids.size(), f.onGpu.triangleCount());
}

TEST_F(CullTest, neverDropsATriangleThatMayBeSeen) {
    Fixture f(device(), small_scenes::jumble());
    small_scenes::Random random(3);
    std::size_t drawn = 0, drawnWithCones = 0;
    for (int view = 0; view < 50; ++view) {
        const Camera camera = randomCamera(random);
        const auto inFrustum = f.run(viewOf(camera, false)).clusters();
        const auto kept = f.run(viewOf(camera, true)).clusters();
        drawn += inFrustum.size();
        drawnWithCones += kept.size();
        const glm::dmat4 clipFromWorld(viewOf(camera).clipFromWorld);
        const auto inside = [&](glm::dvec3 p) {
            const glm::dvec4 c = clipFromWorld * glm::dvec4(p, 1);
            return std::abs(c.x) <= c.w && std::abs(c.y) <= c.w && c.z <= c.w;
        };
        for (std::uint32_t c = 1; c < f.onGpu.clusterCount(); ++c) {
            const glm::dmat3 linear(f.worldFromObject[f.clusters[c].instance]);
            const double handed = glm::determinant(linear) < 0 ? -1 : 1;
            bool some = false, front = false;
            for (std::uint32_t t = 0; t < f.clusters[c].triangleCount; ++t) {
                const auto p = f.world(c, t);
                if (!inside(p[0]) && !inside(p[1]) && !inside(p[2]) &&
                    !inside((p[0] + p[1] + p[2]) / 3.0))
                    continue;
                some = true;
                const glm::dvec3 normal = handed * crossOf(p),
                                 toEye = glm::dvec3(camera.eye) - p[0];
                front |= f.doubleSided(c) ||
                         glm::dot(normal, toEye) > 1e-6 * glm::length(normal) * glm::length(toEye);
            }
            ASSERT_TRUE(!some || inFrustum.contains(c)) << "view " << view << " cluster " << c;
            ASSERT_TRUE(!front || kept.contains(c)) << "view " << view << " cluster " << c;
        }
    }
    EXPECT_LT(drawn, 50 * f.onGpu.clusterCount() / 2) << "hardly anything was culled";
    EXPECT_LT(drawnWithCones, drawn);
}

TEST_F(CullTest, conesDropMostOfTheFarSideOfASphere) {
    Fixture f(device(), small_scenes::single(small_scenes::parts::patch(
                            small_scenes::parts::sphere(1), 96, 48, {1, 1})));
    const Camera camera{.eye = {0, 0, 30}, .at = {0, 0, 0}};
    const double all = double(f.run(viewOf(camera, false)).ids.size());
    EXPECT_EQ(all, f.onGpu.triangleCount());
    EXPECT_LT(double(f.run(viewOf(camera)).ids.size()), 0.75 * all);
}

TEST_F(CullTest, sameViewGivesTheSameBytes) {
    Fixture f(device(), *scene::buildBuiltin("grid:20000"));
    const Camera camera = scene::frame(f.onGpu.bounds(), 1.5f);
    const Drawn first = f.run(viewOf(camera), 0);
    EXPECT_GT(first.ids.size(), 1000u);
    EXPECT_EQ(f.run(viewOf(camera), 0xffffffff), first);
}

TEST_F(CullTest, aSceneWithoutMeshesDrawsNothing) {
    Fixture f(device(), {});
    const Drawn drawn = f.run(viewOf({}));
    EXPECT_TRUE(drawn.ids.empty());
    for (const auto& draw : drawn.draws) EXPECT_EQ(draw.indexCount, 0u);
}

}  // namespace
}  // namespace lodestar::geometry

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/geometry/tessellate.hpp>

#include <cmath>
#include <map>

#include <lodestar/geometry/cull_params.h>
#include <lodestar/scene/displacement.h>
#include <lodestar/shared/octahedral.h>
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"

namespace lodestar::geometry {
namespace {

using gpu::Stage;
using scene::Camera;
using scene::Displacement;
using scene::Scene;

constexpr vk::Extent2D kSize{160, 120};
constexpr Displacement kRelief{.amplitude = 0.2f, .wavelength = 1.7f, .octaves = 3};

/// `across`² quads of `step` a side in the plane y = 0, or in waves, in 2×2 meshes that meet.
Scene ground(int across, float step, float waves) {
    small_scenes::SceneBuilder builder("ground");
    const auto soil = builder.add(small_scenes::parts::plain("soil", {0.3f, 0.5f, 0.2f}, 0, 1));
    const int half = across / 2;
    const auto height = [=](double x, double z) {
        return waves * std::sin(0.7 * x) * std::cos(0.45 * z);
    };
    for (int part = 0; part < 4; ++part) {
        const double x0 = (part % 2 - 1) * half * step, z0 = (part / 2 - 1) * half * step;
        scene::Mesh mesh = small_scenes::parts::patch(
            [=](double u, double v) {
                const double x = x0 + u * half * step, z = z0 + v * half * step;
                return glm::dvec3(x, height(x, z), z);
            },
            std::uint32_t(half), std::uint32_t(half), {4, 4});
        for (scene::Vertex& v : mesh.vertices) {  // of the field, so that the parts agree
            const double x = v.position.x, z = v.position.z;
            v.position.y = float(height(x, z));
            v.normal =
                glm::normalize(glm::vec3(-0.7 * waves * std::cos(0.7 * x) * std::cos(0.45 * z), 1,
                                         0.45 * waves * std::sin(0.7 * x) * std::sin(0.45 * z)));
        }
        mesh.displacement = kRelief;
        builder.place(builder.add("part " + std::to_string(part), std::move(mesh), soil));
    }
    return std::move(builder).finish();
}

struct Point {
    glm::vec3 position;
    std::uint32_t normal;
};
using Triangle = std::array<Point, 3>;

/// What a view without culling draws.
struct Drawn {
    std::vector<Triangle> whole, refined;
    float coarsened = 1;
};

class TessellateTest : public GpuTest {
protected:
    Drawn draw(const Scene& source, const Camera& camera, float wavePx, LodChoice lod = {}) {
        scene::GpuScene onGpu(device(), source);
        Tessellate tessellate(device(), onGpu);
        Cull cull(device());
        DrawList list(device(), onGpu, "test");
        const CullView view{.clipFromWorld = camera.clipFromView(4.0f / 3) * camera.viewFromWorld(),
                            .eye = camera.eye,
                            .size = kSize,
                            .cull = CullMode::none,
                            .lod = lod,
                            .wavePx = wavePx};
        gpu::Recorder rec(device());
        rec.begin();
        tessellate.record(rec, onGpu, view);
        cull.record(rec, onGpu, view, list);
        rec.submit();

        const auto read = [&]<typename T>(const gpu::Buffer& buffer, T) {
            return gpu::as<T>(gpu::readBuffer(device(), buffer, buffer.bytes()));
        };
        const auto counts = read(list.counts, shared::CullCounts{}).front();
        const auto ids = read(list.ids.buffer(), std::uint32_t{});
        const auto clusters = read(onGpu.clusters.buffer(), shared::GpuCluster{});
        const auto triangles = read(onGpu.triangles.buffer(), shared::GpuTriangle{});
        const auto vertices = read(onGpu.vertices.buffer(), shared::GpuVertex{});
        Drawn drawn;
        for (std::uint32_t i = 0; i < counts.lists[shared::LS_LIST_TRIANGLES].count; ++i) {
            const auto& cluster = clusters[ids[i] >> shared::LS_TRIANGLE_BITS];
            const auto& t = triangles[cluster.triangles + (ids[i] & shared::LS_TRIANGLE_MASK)];
            const auto at = [&](std::uint32_t v) {
                return Point{vertices[v].position, vertices[v].normal};
            };
            auto& to = cluster.lod == shared::LS_LOD_REFINED ? drawn.refined : drawn.whole;
            to.push_back({at(t.a), at(t.b), at(t.c)});
        }
        drawn.coarsened = wavePx > 0 ? tessellate.coarsenedBy() : 1;
        return drawn;
    }

    /// Edges in view, and inside the square of `side` about the origin, that only one triangle has.
    /// Beside the view nothing is refined.
    static int openEdges(const Drawn& drawn, float side, const Camera& camera) {
        const glm::mat4 clipFromWorld = camera.clipFromView(4.0f / 3) * camera.viewFromWorld();
        const auto less = [](const glm::vec3& p, const glm::vec3& q) {
            return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
        };
        using Edge = std::pair<glm::vec3, glm::vec3>;
        const auto before = [&](const Edge& p, const Edge& q) {
            if (p.first != q.first) return less(p.first, q.first);
            return less(p.second, q.second);
        };
        std::map<Edge, int, decltype(before)> balance(before);
        for (const auto* some : {&drawn.whole, &drawn.refined})
            for (const Triangle& t : *some)
                for (int i = 0; i < 3; ++i) {
                    const glm::vec3 p = t[i].position, q = t[(i + 1) % 3].position;
                    if (p == q) continue;
                    if (less(p, q))
                        ++balance[{p, q}];
                    else
                        --balance[{q, p}];
                }
        int open = 0;
        for (const auto& [edge, sum] : balance) {
            const auto outside = [&](glm::vec3 p) {
                return std::max(std::abs(p.x), std::abs(p.z)) > 0.49f * side;
            };
            const auto unseen = [&](glm::vec3 p) {
                const glm::vec4 clip = clipFromWorld * glm::vec4(p, 1);
                return std::max(std::abs(clip.x), std::abs(clip.y)) > clip.w;
            };
            if (sum != 0 && !(outside(edge.first) && outside(edge.second)) &&
                !(unseen(edge.first) && unseen(edge.second)))
                ++open;
        }
        return open;
    }
};

Camera above(glm::vec3 eye) {
    return {.eye = eye, .at = {0.1f, 0, 0.2f}, .verticalFov = 1.6f, .nearPlane = 0.05f};
}

TEST_F(TessellateTest, leavesNoCracksWhereverTheEyeIs) {
    const Scene scene = ground(24, 1, 0.6f);
    std::size_t most = 0;
    for (const glm::vec3 eye :
         {glm::vec3(0, 4, 0), glm::vec3(3, 2, -5), glm::vec3(-7, 1.2f, 7), glm::vec3(0.5f, 9, 0)}) {
        const Drawn drawn = draw(scene, above(eye), 6);
        EXPECT_EQ(openEdges(drawn, 24, above(eye)), 0) << eye.x;
        EXPECT_GT(drawn.refined.size(), 300u);
        EXPECT_GT(drawn.whole.size(), 0u);
        most = std::max(most, drawn.refined.size());
    }
    EXPECT_GT(most, 5000u);
}

TEST_F(TessellateTest, levelsOfDetailDoNotTearIt) {
    const Scene scene = ground(64, 1, 0.6f);
    const LodChoice coarse{.mode = LodChoice::Mode::error, .errorPx = 40, .distances = {}};
    const Camera camera = above({-20, 2, -20});
    const Drawn plain = draw(scene, camera, 0, coarse);
    const Drawn drawn = draw(scene, camera, 20, coarse);
    EXPECT_LT(plain.whole.size(), 6000u) << "levels are in use";
    EXPECT_EQ(openEdges(drawn, 64, camera), openEdges(plain, 64, camera));
    EXPECT_GT(drawn.refined.size(), 0u);
}

TEST_F(TessellateTest, pointsLieWhereTheFormulaSays) {
    const Scene scene = ground(16, 1, 0);
    const Camera camera = above({0, 3, 0});
    constexpr float kWave = 8;
    const Drawn drawn = draw(scene, camera, kWave);
    const glm::mat4 rows = glm::transpose(camera.clipFromView(4.0f / 3) * camera.viewFromWorld());
    const float reach = glm::length(glm::vec3(rows[1])) * float(kSize.height) / 2 / kWave;
    float highest = 0;
    for (const Triangle& t : drawn.refined)
        for (const Point& p : t) {
            const glm::vec3 at(p.position.x, 0, p.position.z);
            const glm::vec4 lift =
                shared::displacementAt(at, kRelief.amplitude, kRelief.wavelength, kRelief.octaves,
                                       glm::distance(at, camera.eye), kRelief.wavelength * reach);
            ASSERT_NEAR(p.position.y, lift.w, 2e-4f);
            const glm::vec3 normal = glm::normalize(glm::vec3(-lift.x, 1, -lift.z));
            ASSERT_GT(glm::dot(shared::unpackNormal(p.normal), normal), 0.9999f);
            highest = std::max(highest, std::abs(p.position.y));
        }
    EXPECT_GT(highest, 0.05f);
    EXPECT_LE(highest, kRelief.amplitude);
}

TEST_F(TessellateTest, everyShownWaveHasEdgesShortEnough) {
    const Scene scene = ground(16, 1, 0);
    const Camera camera = above({0, 2, 0});
    constexpr float kWave = 7;
    const Drawn drawn = draw(scene, camera, kWave);
    const float perUnit = float(kSize.height) / 2 / std::tan(camera.verticalFov / 2);
    int checked[shared::LS_TESS_LEVELS] = {};
    for (const auto* some : {&drawn.whole, &drawn.refined})
        for (const Triangle& t : *some)
            for (int i = 0; i < 3; ++i) {
                const glm::vec3 p = t[i].position, q = t[(i + 1) % 3].position;
                const float apart = glm::distance(0.5f * (p + q), camera.eye);
                for (std::uint32_t k = 0; k < shared::LS_TESS_LEVELS; ++k) {
                    const float wave = kRelief.wavelength / float(1u << k);
                    if (wave * perUnit / apart < 1.1f * kWave) continue;
                    ++checked[k];
                    // Diagonals of the mesh are √2 long; relief makes them longer.
                    EXPECT_LT(glm::distance(p, q), 1.3f * std::sqrt(2.0f) / float(2u << k));
                }
            }
    for (const int count : checked) EXPECT_GT(count, 100);
}

TEST_F(TessellateTest, farSurfacesStayAsTheyAre) {
    const Scene scene = ground(16, 1, 0.5f);
    const Drawn far = draw(scene, above({0, 400, 0}), 6);
    EXPECT_TRUE(far.refined.empty());
    EXPECT_EQ(far.whole.size(), 512u);
}

TEST_F(TessellateTest, tooManyTrianglesAreRefinedLessAndStayClosed) {
    const Scene scene = ground(160, 0.125f, 0.1f);
    const Drawn drawn = draw(scene, above({0, 5, 0}), 11);
    EXPECT_GT(drawn.coarsened, 1);
    EXPECT_LT(drawn.coarsened, 8);
    EXPECT_GT(drawn.refined.size(), 4 * shared::LS_TESS_CAPACITY / 4);
    EXPECT_EQ(openEdges(drawn, 20, above({0, 5, 0})), 0);

    const Drawn hopeless = draw(scene, above({0, 5, 0}), 1);
    EXPECT_EQ(hopeless.coarsened, INFINITY);
    EXPECT_TRUE(hopeless.refined.empty());
    EXPECT_EQ(hopeless.whole.size(), 51200u);
}

TEST_F(TessellateTest, occlusionCullingChangesNoPixelOfIt) {
    const Scene scene = ground(24, 1, 1.5f);
    scene::GpuScene onGpu(device(), scene);
    frame::FrameSettings settings;
    settings.size = vk::Extent2D{96, 64};
    settings.shadowTaps = settings.skyViews = 0;
    settings.wavePx = 4;
    settings.lod = {.mode = LodChoice::Mode::error, .errorPx = 1, .distances = {}};
    frame::Frame plain(device(), onGpu, settings);
    settings.cull = CullMode::hiz;
    frame::Frame hidden(device(), onGpu, settings);
    settings.wavePx = 0;
    frame::Frame flat(device(), onGpu, settings);
    small_scenes::Random random(9);
    int changed = 0;
    for (int view = 0; view < 12; ++view) {
        Camera camera{.eye = random.vec3(-9, 9) * glm::vec3(1, 0.1f, 1) + glm::vec3(0, 3, 0),
                      .at = {0, 0, 0},
                      .verticalFov = 1,
                      .nearPlane = 0.05f};
        for (frame::Frame* one : {&plain, &hidden, &flat}) one->render(camera, {});
        const auto picture = [&](const frame::Frame& f) {
            return gpu::readImage(device(), f.display());
        };
        ASSERT_EQ(picture(plain), picture(hidden)) << view;
        changed += picture(plain) != picture(flat);
    }
    EXPECT_EQ(changed, 12);
}

TEST_F(TessellateTest, scenesWithoutReliefDoNotReadItsTables) {
    Scene scene = ground(8, 1, 0.5f);
    for (scene::Mesh& mesh : scene.meshes) mesh.displacement.reset();
    scene::GpuScene onGpu(device(), scene);
    gpu::Buffer& refined = onGpu.relief.refined.buffer();
    refined.upload(std::vector<std::uint32_t>(refined.bytes() / 4, 0x7fffffffu));
    frame::FrameSettings settings;
    settings.size = vk::Extent2D{64, 48};
    settings.shadowTaps = settings.skyViews = 0;
    frame::Frame plain(device(), onGpu, settings);
    settings.wavePx = 16;
    frame::Frame asked(device(), onGpu, settings);
    for (frame::Frame* one : {&plain, &asked}) one->render(above({0, 3, 2}), {});
    EXPECT_EQ(gpu::readImage(device(), plain.display()), gpu::readImage(device(), asked.display()));
}

TEST_F(TessellateTest, reliefWithoutSenseIsRefused) {
    for (const Displacement bad : {Displacement{.amplitude = -1}, Displacement{.amplitude = NAN},
                                   Displacement{.amplitude = 1, .wavelength = 0},
                                   Displacement{.octaves = 0}, Displacement{.octaves = 4}}) {
        Scene scene = ground(2, 1, 0);
        scene.meshes[1].displacement = bad;
        EXPECT_THROW(scene::GpuScene(device(), scene), std::invalid_argument);
    }
}

}  // namespace
}  // namespace lodestar::geometry

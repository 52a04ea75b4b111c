// SPDX-License-Identifier: Apache-2.0
// Skinned and morphed meshes, against the same in double precision.
#include <lodestar/shared/octahedral.h>
#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/deform_reference.hpp>
#include <lodestar/scene/import.hpp>

#include "deforming_scenes.hpp"
#include "gpu_device.hpp"
#include "scenes.hpp"

namespace lodestar::scene {
namespace {

using small_scenes::wavingTubes;

class DeformTest : public GpuTest {
protected:
    struct Stored {
        std::vector<shared::GpuVertex> vertices;
        std::vector<shared::GpuVertexAttributes> attributes;
    };
    static Stored read(const GpuScene& scene) {
        const auto all = [](const gpu::TexelBuffer& b) {
            return gpu::readBuffer(device(), b.buffer(), b.buffer().bytes());
        };
        return {gpu::as<shared::GpuVertex>(all(scene.vertices)),
                gpu::as<shared::GpuVertexAttributes>(all(scene.attributes))};
    }
    /// What deforms, in the order in which it is stored.
    static std::vector<const Instance*> deforming(const Scene& scene) {
        std::vector<const Instance*> found;
        for (const Instance& instance : scene.instances)
            if (deforms(scene, instance)) found.push_back(&instance);
        return found;
    }
    /// Expects the stored vertices where the reference has them.
    static void expectAsReference(const Scene& source, const GpuScene& onGpu, float seconds) {
        const Stored stored = read(onGpu);
        const Pose pose = poseAt(source, seconds);
        const double size = onGpu.bounds().radius();
        std::size_t at = onGpu.firstDeformed();
        for (const Instance* instance : deforming(source)) {
            for (const DeformedVertex& v : deformReference(source, *instance, pose)) {
                const shared::GpuVertex& own = stored.vertices[at];
                ASSERT_LT(glm::distance(glm::dvec3(own.position), v.position), 3e-6 * size)
                    << at << " at " << seconds;
                const glm::dvec3 normal(shared::unpackNormal(own.normal));
                ASSERT_GT(glm::dot(normal, v.normal), 1 - 1e-6) << at << " at " << seconds;
                const glm::dvec3 tangent(shared::unpackTangent(stored.attributes[at].tangent));
                ASSERT_GT(glm::dot(tangent, v.tangent), 1 - 1e-6) << at << " at " << seconds;
                ++at;
            }
        }
        EXPECT_EQ(at, stored.vertices.size());
    }
    /// Expects every bound to hold what it is of.
    static void expectInBounds(const Scene& source, const GpuScene& onGpu, float seconds) {
        const Pose pose = poseAt(source, seconds);
        const auto all = [](const gpu::TexelBuffer& b) {
            return gpu::readBuffer(device(), b.buffer(), b.buffer().bytes());
        };
        const auto instances = gpu::as<shared::GpuInstance>(all(onGpu.instances));
        const auto meshes = gpu::as<shared::GpuMesh>(all(onGpu.meshes));
        const auto lods = gpu::as<shared::GpuLod>(all(onGpu.lods));
        const auto meshlets = gpu::as<shared::GpuMeshlet>(all(onGpu.meshlets));
        const auto triangles = gpu::as<shared::GpuTriangle>(all(onGpu.triangles));
        const auto chunks = gpu::as<shared::GpuChunk>(all(onGpu.chunks));
        const auto order = gpu::as<std::uint32_t>(all(onGpu.drawOrder));
        const std::vector<shared::GpuVertex> vertices = read(onGpu).vertices;
        for (const shared::GpuChunk& chunk : chunks)
            for (std::uint32_t o = chunk.first; o < chunk.first + chunk.count; ++o) {
                const Instance& instance = source.instances[order[o]];
                const shared::GpuMesh& mesh = meshes[instances[order[o]].mesh];
                const glm::mat4 world = pose.worldFromNode[instance.node] * instance.nodeFromObject;
                const shared::GpuLod& lod = lods[mesh.firstLod];
                for (std::uint32_t m = 0; m < lod.meshletCount; ++m) {
                    const shared::GpuMeshlet& meshlet = meshlets[lod.firstMeshlet + m];
                    for (std::uint32_t t = 0; t < meshletTriangles(meshlet); ++t) {
                        const shared::GpuTriangle& corners = triangles[meshlet.triangles + t];
                        for (const std::uint32_t v : {corners.a, corners.b, corners.c}) {
                            const glm::dvec3 p(vertices[v].position);
                            ASSERT_LE(glm::distance(p, glm::dvec3(meshlet.centre)), meshlet.radius);
                            ASSERT_LE(glm::distance(p, glm::dvec3(mesh.centre)), mesh.radius);
                            const glm::dvec3 w(glm::dmat4(world) * glm::dvec4(p, 1));
                            ASSERT_LE(glm::distance(w, glm::dvec3(chunk.centre)), chunk.radius);
                            for (int axis = 0; axis < 3; ++axis) {
                                ASSERT_GE(w[axis], onGpu.bounds().lower[axis] - 1e-5);
                                ASSERT_LE(w[axis], onGpu.bounds().upper[axis] + 1e-5);
                            }
                        }
                    }
                }
            }
    }
    static frame::FrameSettings settings(vk::Extent2D size) {
        frame::FrameSettings s;
        s.size = size;
        s.shadowTaps = 0;
        s.skyViews = 0;
        return s;
    }
    static Camera view() { return {.eye = {0.3f, 1.6f, 6.5f}, .at = {0, 1.2f, 0}}; }
};

TEST_F(DeformTest, everyVertexIsWhereTheReferenceHasIt) {
    const Scene source = wavingTubes();
    GpuScene onGpu(device(), source);
    for (const float seconds : {0.0f, 0.3f, 1.0f, 1.7f, 2.4f}) {
        onGpu.animate(seconds);
        expectAsReference(source, onGpu, seconds);
    }
}

TEST_F(DeformTest, whatDoesNotDeformStaysAsItIs) {
    const Scene source = wavingTubes();
    GpuScene onGpu(device(), source);
    const Stored before = read(onGpu);
    onGpu.animate(0.9f);
    const Stored after = read(onGpu);
    const std::size_t fixed = onGpu.firstDeformed();
    ASSERT_GT(fixed, 24u);
    EXPECT_EQ(std::memcmp(before.vertices.data(), after.vertices.data(),
                          fixed * sizeof(shared::GpuVertex)),
              0);
    EXPECT_NE(std::memcmp(before.vertices.data(), after.vertices.data(),
                          before.vertices.size() * sizeof(shared::GpuVertex)),
              0);
    for (std::size_t i = 0; i < before.attributes.size(); ++i) {
        ASSERT_EQ(before.attributes[i].uv, after.attributes[i].uv);
        ASSERT_EQ(before.attributes[i].color, after.attributes[i].color);
    }
}

TEST_F(DeformTest, boundsHoldTheDeformedVertices) {
    const Scene source = wavingTubes();
    GpuScene onGpu(device(), source);
    for (int i = 0; i < 8; ++i) {
        onGpu.animate(0.27f * float(i));
        expectInBounds(source, onGpu, 0.27f * float(i));
    }
}

TEST_F(DeformTest, sampleFiguresAreAsTheReferenceHasThem) {
    REQUIRE_SCENES();
    for (const char* file :
         {"CesiumMan.glb", "Fox.glb", "RiggedFigure.glb", "MorphStressTest.glb"}) {
        const auto loaded = load((scenesFolder() / "tests" / file).string());
        ASSERT_TRUE(loaded) << loaded.error().message;
        GpuScene onGpu(device(), *loaded);
        ASSERT_TRUE(onGpu.deforms()) << file;
        for (const float seconds : {0.0f, 0.8f, 1.9f}) {
            SCOPED_TRACE(file);
            onGpu.animate(seconds);
            expectAsReference(*loaded, onGpu, seconds);
            expectInBounds(*loaded, onGpu, seconds);
        }
    }
}

TEST_F(DeformTest, motionIsTheDifferenceOfTheReferencesPositions) {
    const Scene source = wavingTubes();
    GpuScene onGpu(device(), source);
    constexpr vk::Extent2D kSize{96, 72};
    frame::FrameSettings s = settings(kSize);
    s.motion = true;
    frame::Frame frame(device(), onGpu, s);
    const Camera a = view();
    Camera b = a;
    b.eye.x += 0.2f;
    onGpu.animate(0.3f);
    frame.render(a, {});
    onGpu.animate(0.45f);
    frame.render(b, {});
    const auto motion = gpu::as<glm::vec4>(gpu::readImage(device(), frame.motion()));
    const auto ids = gpu::as<std::uint32_t>(gpu::readImage(device(), frame.ids()));
    const auto all = [](const gpu::TexelBuffer& buffer) {
        return gpu::readBuffer(device(), buffer.buffer(), buffer.buffer().bytes());
    };
    const auto clusters = gpu::as<shared::GpuCluster>(all(onGpu.clusters));
    const auto triangles = gpu::as<shared::GpuTriangle>(all(onGpu.triangles));
    // Corners of what deforms in the world, then and now.
    const Pose then = poseAt(source, 0.3f), now = poseAt(source, 0.45f);
    std::vector<glm::dvec3> before, after;
    for (const Instance* instance : deforming(source)) {
        const auto add = [&](const Pose& pose, std::vector<glm::dvec3>& to) {
            const glm::dmat4 world(pose.worldFromNode[instance->node]);
            for (const DeformedVertex& v : deformReference(source, *instance, pose))
                to.push_back(glm::dvec3(world * glm::dvec4(v.position, 1)));
        };
        add(then, before);
        add(now, after);
    }
    const double aspect = double(kSize.width) / kSize.height;
    const auto clipOf = [&](const Camera& camera, glm::dvec3 p) {
        return glm::dmat4(camera.clipFromView(float(aspect))) * glm::dmat4(camera.viewFromWorld()) *
               glm::dvec4(p, 1);
    };
    const glm::dvec2 size(kSize.width, kSize.height);
    int deformed = 0;
    double moved = 0;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (ids[i] == 0) continue;
        const shared::GpuCluster& cluster = clusters[ids[i] >> shared::LS_TRIANGLE_BITS];
        const shared::GpuTriangle& t =
            triangles[cluster.triangles + (ids[i] & shared::LS_TRIANGLE_MASK)];
        if (t.a < onGpu.firstDeformed()) continue;
        // Weights of the corners at the pixel: those whose sum of clip positions lies on its ray.
        const glm::dvec2 ndc =
            (glm::dvec2(i % kSize.width, i / kSize.width) + 0.5) / size * 2.0 - 1.0;
        glm::dmat3 m;
        int column = 0;
        std::array<glm::dvec4, 3> was;
        for (const std::uint32_t v : {t.a, t.b, t.c}) {
            const std::size_t at = v - onGpu.firstDeformed();
            const glm::dvec4 clip = clipOf(b, after[at]);
            m[column] = {clip.x - ndc.x * clip.w, clip.y - ndc.y * clip.w, 1};
            was[std::size_t(column++)] = clipOf(a, before[at]);
        }
        const glm::dvec3 weights = glm::inverse(m) * glm::dvec3(0, 0, 1);
        const glm::dvec4 clip = was[0] * weights.x + was[1] * weights.y + was[2] * weights.z;
        const glm::dvec2 wanted = (glm::dvec2(clip) / clip.w - ndc) * 0.5;
        ASSERT_LT(glm::length((glm::dvec2(motion[i]) - wanted) * size), 5e-3) << i;
        ASSERT_NEAR(motion[i].z, clip.w, 1e-4 * clip.w);
        ++deformed;
        moved = std::max(moved, glm::length(wanted * size));
    }
    EXPECT_GT(deformed, 400);
    EXPECT_GT(moved, 3);
    // Standing still again it has no motion left over.
    frame.render(b, {});
    for (const glm::vec4 still : gpu::as<glm::vec4>(gpu::readImage(device(), frame.motion())))
        ASSERT_LT(glm::length(glm::vec2(still)), 1e-5);
}

TEST_F(DeformTest, picturesAreTheSameWithAndWithoutOcclusionCulling) {
    const Scene source = wavingTubes();
    GpuScene onGpu(device(), source);
    frame::FrameSettings s = settings({93, 61});
    s.shadowTaps = 2;
    s.shadowMapSize = 128;
    s.cull = geometry::CullMode::none;
    frame::Frame plain(device(), onGpu, s);
    s.cull = geometry::CullMode::hiz;
    frame::Frame hiz(device(), onGpu, s);
    std::uint64_t hidden = 0;
    for (int i = 0; i < 24; ++i) {
        // Past the box, from behind it, and up to the tubes.
        const float turn = 0.26f * float(i);
        const float near = i % 6 == 5 ? 1.7f : 5.0f;
        const Camera camera{.eye = {near * std::sin(turn), 0.6f, near * std::cos(turn)},
                            .at = {0, 0.8f, 0},
                            .verticalFov = 0.9f,
                            .nearPlane = 0.05f};
        onGpu.animate(0.13f * float(i));
        plain.render(camera, {});
        const auto expected = gpu::readImage(device(), plain.display());
        hiz.render(camera, {});
        ASSERT_EQ(gpu::readImage(device(), hiz.display()), expected) << "view " << i;
        const auto counts = gpu::as<shared::CullCounts>(
            gpu::readBuffer(device(), hiz.drawList().counts, sizeof(shared::CullCounts)))[0];
        hidden += counts.instancesHidden + counts.clustersHidden;
    }
    EXPECT_GT(hidden, 40u) << "hardly anything was hidden";
}

TEST_F(DeformTest, aCaptureByAnyBackendRebuildsToThePictureOfItsTime) {
    const Scene source = wavingTubes();
    GpuScene onGpu(device(), source);
    onGpu.animate(0.8f);
    constexpr vk::Extent2D kSize{64, 48};
    frame::Frame frame(device(), onGpu, settings(kSize));
    frame.render(view(), {});
    const auto expected = gpu::readImage(device(), frame.display());
    using frame::CaptureBackend;
    for (const CaptureBackend backend : {CaptureBackend::supersample, CaptureBackend::compute}) {
        frame::CaptureFrame capture(device(), onGpu,
                                    {.base = kSize, .side = 1, .backend = backend});
        capture.capture(view());
        frame.rebuild(capture.compact(), view(), {});
        const auto rebuilt = gpu::readImage(device(), frame.display());
        std::size_t different = 0;
        for (std::size_t i = 0; i < rebuilt.size(); i += 4)
            different += std::memcmp(&rebuilt[i], &expected[i], 4) != 0;
        // The compute backend snaps vertices by itself.
        EXPECT_LE(different, backend == CaptureBackend::compute ? 12u : 0u);
    }
    // Multisampled at four a pixel, each sample as supersampling has it, but for snapping.
    std::array<std::vector<std::uint32_t>, 2> found;
    for (const CaptureBackend backend :
         {CaptureBackend::supersample, CaptureBackend::multisample}) {
        frame::CaptureFrame capture(device(), onGpu,
                                    {.base = kSize, .side = 4, .backend = backend});
        capture.capture(view());
        frame.rebuild(capture.compact(), view(), {});
        found[backend == CaptureBackend::multisample] =
            gpu::as<std::uint32_t>(gpu::readImage(device(), frame.display()));
    }
    std::size_t different = 0;
    for (std::size_t i = 0; i < found[0].size(); ++i) different += found[0][i] != found[1][i];
    EXPECT_LE(different, found[0].size() / 100);
}

TEST_F(DeformTest, aMirroredMeshShowsItsOutside) {
    Scene source = wavingTubes();
    source.nodes[source.skins[0].joints[0]].scale.x = -1;
    // As the importer does for joints that mirror: this mesh's triangles turn around.
    Mesh turned = source.meshes[source.instances[2].mesh];
    for (std::size_t i = 0; i < turned.indices.size(); i += 3)
        std::swap(turned.indices[i + 1], turned.indices[i + 2]);
    source.instances[2].mesh = static_cast<std::uint32_t>(source.meshes.size());
    source.meshes.push_back(turned);
    GpuScene onGpu(device(), source);
    onGpu.animate(0.4f);
    expectAsReference(source, onGpu, 0.4f);
    frame::Frame frame(device(), onGpu, settings({64, 48}));
    frame.render(view(), {});
    const auto normals = gpu::as<std::uint32_t>(gpu::readImage(device(), frame.normal()));
    const auto depths = gpu::as<float>(gpu::readImage(device(), frame.depth()));
    for (std::size_t i = 0; i < normals.size(); ++i)
        if (depths[i] > 0) {
            ASSERT_GT(shared::unpackNormal(normals[i]).z, -0.35f) << i;
        }
}

}  // namespace
}  // namespace lodestar::scene

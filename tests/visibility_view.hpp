// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include <lodestar/shared/octahedral.h>
#include <lodestar/visibility/view_params.h>
#include <lodestar/geometry/cull.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/visibility/capture_ss.hpp>
#include <lodestar/visibility/rebuild.hpp>
#include <lodestar/visibility/rebuild_reference.hpp>

/// Visibility and rebuilt surface of one view, on the device and by the reference.
namespace lodestar::visibility {

using gpu::Slot;
using gpu::Stage;
using scene::Camera;
using scene::Scene;

inline constexpr std::uint32_t kProbeCode[] =
#include <tests/visibility_test.comp.inc>
    ;

/// Barycentrics of triangle.glsl.
struct Found {
    glm::vec3 at, dx, dy;
    float depth;
};

/// Everything the passes say about one view, read back.
struct Picture {
    vk::Extent2D size;
    std::vector<std::uint32_t> ids, normals;
    std::vector<float> depths, depthBuffer;
    std::vector<glm::uvec4> materials;
    std::vector<Found> found;

    std::size_t at(std::uint32_t x, std::uint32_t y) const { return y * size.width + x; }
    glm::vec2 centre(std::size_t pixel) const {
        return {float(pixel % size.width) + 0.5f, float(pixel / size.width) + 0.5f};
    }
    glm::vec4 albedo(std::size_t pixel) const {
        const glm::vec4 root = glm::unpackUnorm4x8(materials[pixel].x);
        return {root.r * root.r, root.g * root.g, root.b * root.b, root.a};
    }
    /// Roughness, metallic.
    glm::vec2 roughMetal(std::size_t pixel) const {
        return glm::vec2(glm::unpackUnorm4x8(materials[pixel].y));
    }
    glm::vec3 viewNormal(std::size_t pixel) const { return shared::unpackNormal(normals[pixel]); }
    std::size_t covered() const {
        return ids.size() - std::size_t(std::count(ids.begin(), ids.end(), 0u));
    }
};

/// A scene on the device with the passes that show it.
struct View {
    Scene source;
    scene::GpuScene onGpu;
    geometry::Cull cull;
    CaptureSs capture;
    Rebuild rebuild;
    gpu::Kernel probe;
    vk::raii::Sampler sampler;
    gpu::Recorder rec;
    std::vector<shared::GpuCluster> clusters;  ///< of the last picture
    std::vector<shared::GpuTriangle> triangles;

    View(const gpu::Device& device, Scene scene)
        : source(std::move(scene)),
          onGpu(device, source, {}, {.simplify = false}),
          cull(device),
          capture(device, onGpu.features()),
          rebuild(device, onGpu.features()),
          probe(device, "probe", kProbeCode,
                scene::withSceneSlots(
                    {Slot::uniformBuffer, Slot::sampledImage, Slot::storageBuffer})),
          sampler(device.vk(), vk::SamplerCreateInfo{}),
          rec(device),
          triangles(records<shared::GpuTriangle>(onGpu.triangles)) {}

    template <typename T>
    std::vector<T> records(const gpu::TexelBuffer& b) {
        return gpu::as<T>(gpu::readBuffer(rec.device(), b.buffer(), b.buffer().bytes()));
    }

    static glm::mat4 clipFromWorld(const Camera& camera, vk::Extent2D size) {
        return camera.clipFromView(float(size.width) / float(size.height)) * camera.viewFromWorld();
    }

    Picture draw(const Camera& camera, vk::Extent2D size) {
        const gpu::Device& device = rec.device();
        using Usage = vk::ImageUsageFlagBits;
        const auto target = [&](vk::Format format, Usage usage) {
            return gpu::Image(device, {.name = "target",
                                       .format = format,
                                       .extent = size,
                                       .usage = usage | Usage::eSampled | Usage::eTransferSrc});
        };
        const gpu::Image ids = target(vk::Format::eR32Uint, Usage::eColorAttachment);
        const gpu::Image depth = target(vk::Format::eD32Sfloat, Usage::eDepthStencilAttachment);
        const Surface surface(device, size);
        const gpu::Buffer found(device, "found", sizeof(Found) * size.width * size.height);
        const gpu::Buffer view(device, "view", sizeof(shared::ViewParams), gpu::Residence::mapped);
        const glm::mat4 clip = clipFromWorld(camera, size);
        *view.mapped<shared::ViewParams>() = {
            .clipFromWorld = clip, .viewFromWorld = camera.viewFromWorld(), .eye = camera.eye};
        geometry::DrawList list(device, onGpu, "list");

        rec.begin();
        cull.record(rec, onGpu, {.clipFromWorld = clip, .eye = camera.eye, .size = size}, list);
        rec.barrier(Stage::compute, Stage::raster);
        rec.barrier(Stage::compute, Stage::indirect);
        capture.record(rec, onGpu, list, clip, {ids, depth}, "capture");
        rec.barrier(Stage::raster, Stage::compute);
        rebuild.record(rec, onGpu, {ids, view}, surface);
        rec.dispatch(probe, gpu::groups8x8(size),
                     scene::withScene(onGpu, {view, {ids, sampler}, found}));
        rec.submit();

        clusters = records<shared::GpuCluster>(onGpu.clusters);
        return {.size = size,
                .ids = gpu::as<std::uint32_t>(gpu::readImage(device, ids)),
                .normals = gpu::as<std::uint32_t>(gpu::readImage(device, surface.normal)),
                .depths = gpu::as<float>(gpu::readImage(device, surface.depth)),
                .depthBuffer = gpu::as<float>(gpu::readImage(device, depth)),
                .materials = gpu::as<glm::uvec4>(gpu::readImage(device, surface.material)),
                .found = gpu::as<Found>(gpu::readBuffer(device, found, found.bytes()))};
    }

    /// The triangle an id names, from the scene in memory.
    reference::Triangle triangle(std::uint32_t id) const {
        const shared::GpuCluster& cluster = clusters[id >> shared::LS_TRIANGLE_BITS];
        const shared::GpuTriangle& stored =
            triangles[cluster.triangles + (id & shared::LS_TRIANGLE_MASK)];
        const scene::Instance& instance = source.instances[cluster.instance];
        std::uint32_t firstVertex = 0;
        for (std::uint32_t m = 0; m < instance.mesh; ++m)
            firstVertex += std::uint32_t(source.meshes[m].vertices.size());
        const glm::dmat4 world(worldFromNode(source)[instance.node] * instance.nodeFromObject);
        const glm::dmat3 normalMatrix = glm::transpose(glm::inverse(glm::dmat3(world)));
        reference::Triangle t;
        const std::array corners{stored.a, stored.b, stored.c};
        for (int i = 0; i < 3; ++i) {
            const scene::Vertex& v =
                source.meshes[instance.mesh].vertices[corners[i] - firstVertex];
            t.world[i] = world * glm::dvec4(v.position, 1);
            t.normal[i] = normalMatrix * glm::dvec3(v.normal);
            t.uv[i] = v.uv0;
        }
        return t;
    }
    reference::Surface expected(const Picture& picture, std::size_t pixel,
                                const Camera& camera) const {
        return reference::rebuild(triangle(picture.ids[pixel]),
                                  glm::dmat4(clipFromWorld(camera, picture.size)),
                                  picture.centre(pixel), {picture.size.width, picture.size.height});
    }
};

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/scene/deform_params.h>
#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

/// Moves the vertices of instances that joints and morph weights deform, on the device, and the
/// bounding spheres of their meshlets with them.
class Deform {
public:
    /// One such instance, which has vertices and meshlets of its own.
    struct Part {
        std::uint32_t instance;
        std::uint32_t firstVertex;  ///< of as many as its mesh has
    };
    /// The meshlets of all parts are `meshletCount` from `firstMeshlet` on.
    Deform(const gpu::Device&, const Scene&, const std::vector<Part>&, std::uint32_t firstMeshlet,
           std::uint32_t meshletCount);

    /// Those of GpuScene.
    struct Geometry {
        const gpu::TexelBuffer &vertices, &attributes, &triangles, &meshlets;
    };
    /// Deforms all parts to `pose` and waits. Passes "deform" and "deform: bounds".
    gpu::FrameTimes run(const Scene&, const Pose&, const Geometry&);

private:
    struct Packed;
    Deform(const gpu::Device&, Packed&&, std::uint32_t firstMeshlet, std::uint32_t meshletCount);

    /// A part and where its mesh's data lie.
    struct Job {
        std::uint32_t instance, targets;
        std::uint32_t firstDelta;
        shared::DeformParams params;
    };
    void upload(const Scene&, const Pose&);

    gpu::Kernel deform, bounds;
    std::vector<Job> jobs;
    std::uint32_t firstMeshlet, meshletCount;
    gpu::TexelBuffer rest, influences, deltas, joints, active;
    gpu::Recorder rec;
};

}  // namespace lodestar::scene

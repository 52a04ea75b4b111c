// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/prefix_sum.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::geometry {

/// A view to cull for.
struct CullView {
    glm::mat4 clipFromWorld{1};  ///< reversed depth; orthographic or perspective
    glm::vec3 eye{0};            ///< world; used for normal cones
    vk::Extent2D size;           ///< of the target [pixels]
    bool perspective = true;
    bool keepBeforeNear = false;  ///< do not cull what lies before the near plane (shadow casters)
};

/// The triangles of one view, ready to draw: their ids in cluster order, and one
/// indirect draw a bin. Deterministic: the same view gives the same bytes.
struct DrawList {
    DrawList(const gpu::Device&, const scene::GpuScene&, const std::string& name);

    gpu::Buffer clusterOffsets;   ///< visible clusters before each cluster; the total at the end
    gpu::Buffer visible;          ///< the visible clusters, in order
    gpu::Buffer counts;           ///< shared::VisibleCounts
    gpu::Buffer masks;            ///< of each visible cluster: a bit for each triangle kept
    gpu::Buffer triangleOffsets;  ///< triangles before each visible cluster
    gpu::TexelBuffer ids;         ///< cluster << 7 | meshlet triangle
    gpu::Buffer draws;            ///< vk::DrawIndirectCommand for each scene::DrawBin
};

/// Culling on the GPU without read-back: clusters by frustum and normal cone, then the triangles of
/// those that remain by frustum, facing and size. What is dropped could not have covered a sample.
class Cull {
public:
    explicit Cull(const gpu::Device&);

    /// Writes `list`, visible to compute; the caller makes it visible to raster and indirect.
    /// Throws std::invalid_argument for a view without a size.
    void record(gpu::Recorder&, const scene::GpuScene&, const CullView&, DrawList& list) const;

private:
    gpu::Kernel clusters, compact, triangles, emit;
    gpu::PrefixSum prefixSum;
};

}  // namespace lodestar::geometry

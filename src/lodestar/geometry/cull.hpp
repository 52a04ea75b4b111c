// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/prefix_sum.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::geometry {

/// A view to cull for.
struct CullView {
    glm::mat4 clipFromWorld{1};  ///< reversed depth; orthographic or perspective
    glm::vec3 eye{0};            ///< world; used for normal cones
    bool perspective = true;
    bool keepBeforeNear = false;  ///< do not cull what lies before the near plane (shadow casters)
};

/// The triangles of one view, ready to draw: an index and id list in cluster order, and one indirect
/// draw a bin. Deterministic: the same view gives the same bytes.
struct DrawList {
    DrawList(const gpu::Device&, const scene::GpuScene&, const std::string& name);

    gpu::Buffer offsets;   ///< triangles before each cluster; the total at clusterCount()
    gpu::Buffer indices;   ///< cluster << 6 | meshlet vertex, three a triangle
    gpu::TexelBuffer ids;  ///< cluster << 7 | meshlet triangle
    gpu::Buffer draws;     ///< vk::DrawIndexedIndirectCommand for each scene::DrawBin
};

/// Frustum and normal-cone culling of all clusters on the GPU, without read-back.
class Cull {
public:
    explicit Cull(const gpu::Device&);

    /// Writes `list`, visible to compute; the caller makes it visible to raster and indirect.
    void record(gpu::Recorder&, const scene::GpuScene&, const CullView&, DrawList& list) const;

private:
    gpu::Kernel cull, emit;
    gpu::PrefixSum prefixSum;
};

}  // namespace lodestar::geometry

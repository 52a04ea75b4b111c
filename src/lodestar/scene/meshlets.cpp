// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/meshlets.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <meshoptimizer.h>

namespace lodestar::scene {
namespace {

// Trades roundness for a narrower normal cone. Higher values save few more triangles on real models
// and cost more meshlets.
constexpr float kConeWeight = 0.25f;

void checkIndices(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
    if (indices.size() % 3 != 0)
        throw std::invalid_argument("buildMeshlets: the indices are not a list of triangles");
    for (std::uint32_t index : indices)
        if (index >= vertices)
            throw std::invalid_argument("buildMeshlets: an index is out of range");
}

/// meshoptimizer leaves degenerate triangles out of its bounds, and rounds; ours hold every vertex.
void setBounds(Meshlet& meshlet, const meshopt_Bounds& bounds, const std::uint32_t* own,
               const std::vector<Vertex>& vertices) {
    meshlet.centre = {bounds.center[0], bounds.center[1], bounds.center[2]};
    meshlet.coneAxis = {bounds.cone_axis[0], bounds.cone_axis[1], bounds.cone_axis[2]};
    meshlet.coneCutoff = bounds.cone_cutoff;
    if (meshlet.coneAxis == glm::vec3(0)) {  // nothing but degenerate triangles
        Bounds box;
        for (std::uint32_t i = 0; i < meshlet.vertexCount; ++i) box.add(vertices[own[i]].position);
        meshlet.centre = box.centre();
        meshlet.coneAxis = {0, 0, 1};
        meshlet.coneCutoff = 1;
    }
    float radius = bounds.radius;
    for (std::uint32_t i = 0; i < meshlet.vertexCount; ++i)
        radius = std::max(radius, glm::distance(vertices[own[i]].position, meshlet.centre));
    // One rounding of the centre and of a distance, so that the sphere holds its vertices in exact
    // arithmetic too.
    meshlet.radius = radius * (1 + 1e-6f) + 1e-7f * glm::length(meshlet.centre);
}

}  // namespace

MeshletSet buildMeshlets(const Mesh& mesh) {
    return buildMeshlets(mesh.vertices, mesh.indices);
}

MeshletSet buildMeshlets(const std::vector<Vertex>& vertices,
                         const std::vector<std::uint32_t>& indices) {
    MeshletSet set;
    checkIndices(indices, vertices.size());
    if (indices.empty()) return set;

    const std::size_t bound =
        meshopt_buildMeshletsBound(indices.size(), kMeshletVertices, kMeshletTriangles);
    std::vector<meshopt_Meshlet> built(bound);
    std::vector<std::uint8_t> corners(bound * kMeshletTriangles * 3);
    set.vertices.resize(bound * kMeshletVertices);
    const float* positions = &vertices[0].position.x;
    built.resize(meshopt_buildMeshlets(built.data(), set.vertices.data(), corners.data(),
                                       indices.data(), indices.size(), positions, vertices.size(),
                                       sizeof(Vertex), kMeshletVertices, kMeshletTriangles,
                                       kConeWeight));
    const meshopt_Meshlet& last = built.back();
    set.vertices.resize(last.vertex_offset + last.vertex_count);
    set.vertices.shrink_to_fit();
    set.meshlets.reserve(built.size());
    set.triangles.reserve(indices.size() / 3);
    for (const meshopt_Meshlet& from : built) {
        Meshlet& meshlet = set.meshlets.emplace_back();
        meshlet.vertexOffset = from.vertex_offset;
        meshlet.triangleOffset = static_cast<std::uint32_t>(set.triangles.size());
        meshlet.vertexCount = from.vertex_count;
        meshlet.triangleCount = from.triangle_count;
        const std::uint32_t* own = &set.vertices[from.vertex_offset];
        const std::uint8_t* corner = &corners[from.triangle_offset];
        setBounds(meshlet,
                  meshopt_computeMeshletBounds(own, corner, from.triangle_count, positions,
                                               vertices.size(), sizeof(Vertex)),
                  own, vertices);
        for (std::uint32_t i = 0; i < from.triangle_count; ++i, corner += 3)
            set.triangles.push_back(std::uint32_t(corner[0]) | std::uint32_t(corner[1]) << 8 |
                                    std::uint32_t(corner[2]) << 16);
    }
    return set;
}

}  // namespace lodestar::scene

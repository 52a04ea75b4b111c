// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

inline constexpr std::uint32_t kMeshletVertices = 64;
inline constexpr std::uint32_t kMeshletTriangles = 124;

/// A patch of a mesh: at most 64 vertices and 124 triangles, with bounds for culling (object
/// space).
struct Meshlet {
    std::uint32_t vertexOffset = 0;    ///< first entry in MeshletSet::vertices
    std::uint32_t triangleOffset = 0;  ///< first entry in MeshletSet::triangles
    std::uint32_t vertexCount = 0, triangleCount = 0;
    glm::vec3 centre{0};
    float radius = 0;
    /// Normal cone: the meshlet faces away from every eye for which
    /// dot(centre − eye, axis) ≥ cutoff · |centre − eye| + radius. cutoff = 1 never culls.
    glm::vec3 coneAxis{0, 0, 1};
    float coneCutoff = 1;
};

/// One mesh cut into meshlets.
struct MeshletSet {
    std::vector<Meshlet> meshlets;
    std::vector<std::uint32_t> vertices;   ///< indices into Mesh::vertices
    std::vector<std::uint32_t> triangles;  ///< a | b << 8 | c << 16, meshlet-local vertex numbers
};

/// Cuts every triangle of `mesh` into exactly one meshlet (degenerate ones included).
/// The result is a function of the mesh alone.
MeshletSet buildMeshlets(const Mesh& mesh);
/// The same for other triangles over the vertices of a mesh.
MeshletSet buildMeshlets(const std::vector<Vertex>& vertices,
                         const std::vector<std::uint32_t>& indices);

}  // namespace lodestar::scene

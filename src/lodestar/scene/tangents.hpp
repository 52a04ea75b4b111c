// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include <lodestar/scene/scene.hpp>

/// What an importer does to a mesh whose file lacks normals or tangents.
namespace lodestar::scene {

/// Merges vertices that are equal in every bit. The triangles stay as they are and in order.
void weldVertices(Mesh&);

/// Flat shading, as glTF asks for where normals are missing: every triangle gets its own vertices
/// with its face normal (those of coplanar neighbours that turn out equal are merged again).
void generateFlatNormals(Mesh&);

/// Smooth shading: normals averaged over the faces about a vertex, weighted by their areas.
/// For formats where shared vertices mean a smooth surface (PLY, STL welded, …).
void generateSmoothNormals(Mesh&);

/// Makes all normals unit length; those that are no direction (zero, denormal) become the average
/// of the faces about the vertex.
void repairNormals(Mesh&);

/// Tangents along the u direction of UV set `uvSet` after `uvTransform` (TextureUse), averaged over
/// the faces about a vertex by area, perpendicular to the normal, w by glTF's convention (+1 where
/// the image is not mirrored). Vertices between a mirrored and an unmirrored face are split.
/// Needs unit normals. Where UVs are degenerate any perpendicular direction is taken.
void generateTangents(Mesh&, std::uint32_t uvSet = 0,
                      const glm::mat3x2& uvTransform = glm::mat3x2(1, 0, 0, 1, 0, 0));

/// Makes all tangents unit length and w ±1; those that are no direction become any perpendicular.
void repairTangents(Mesh&);

}  // namespace lodestar::scene

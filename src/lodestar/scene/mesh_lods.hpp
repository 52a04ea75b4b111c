// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <lodestar/scene/meshlets.hpp>

namespace lodestar::scene {

inline constexpr std::size_t kMaxLods = 15;

/// How a level was made of the mesh.
enum class LodMethod : std::uint32_t {
    whole,       ///< the mesh itself
    simplified,  ///< edges collapsed; borders and attribute seams stay closed
    welded,      ///< the same over welded positions, where split normals left nothing to collapse
    opened,      ///< the same with free borders, where locked ones left nothing to collapse
    sloppy,      ///< vertices clustered, whatever the connectivity
};
const char* nameOf(LodMethod);

/// One level of detail: the meshlets index the vertices of the mesh, which all levels share.
struct MeshLod {
    MeshletSet meshlets;
    /// How wrong it looks, as a distance: what may be seen of it at a size at which this is more
    /// than a pixel. More than offPlace, and the more where textures slide or light falls wrongly.
    float error = 0;     ///< [object units]
    float offPlace = 0;  ///< how far the surface may lie from that of the mesh [object units]
    LodMethod method = LodMethod::whole;
};

/// The levels of a mesh, finest first: each has at most 4/5 of the triangles of the one before, no
/// more meshlets, and no smaller error.
struct MeshLods {
    std::vector<MeshLod> levels;
};

struct LodSettings {
    bool simplify = true;         ///< false: only the meshes themselves
    std::filesystem::path cache;  ///< a folder to keep the chains in; empty: none
};

/// The folder of the user's caches: $XDG_CACHE_HOME/lodestar, else ~/.cache/lodestar; empty when
/// neither variable is set.
std::filesystem::path userCacheFolder();

/// Halves the triangles of `mesh` (≥ 1 level, the mesh itself) until nothing is gained. Meshes with
/// a position that is not finite stay whole. `textured`: its texture coordinates matter.
/// The result is a function of the arguments alone.
MeshLods buildMeshLods(const Mesh& mesh, bool textured);

/// The chains of all meshes of the scene, in order, built on all cores; `progress` (may be empty)
/// is called on the calling thread with the meshes done.
std::vector<MeshLods> buildSceneLods(const Scene&, const LodSettings&,
                                     const std::function<void(int, int)>& progress = {});

// The cache: one file a mesh, named by the hash of what the chain was built of.

/// Name of the file that holds the chain of `mesh`.
std::string lodCacheName(const Mesh& mesh, bool textured);
std::vector<std::byte> encodeLods(const MeshLods&);
/// None when the bytes are not a whole, sound chain of `mesh`; every byte is checked.
std::optional<MeshLods> decodeLods(std::span<const std::byte>, const Mesh& mesh);

}  // namespace lodestar::scene

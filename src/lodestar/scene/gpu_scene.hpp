// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>

#include <lodestar/scene/gpu_types.h>
#include <lodestar/gpu/buffer.hpp>
#include <lodestar/gpu/image.hpp>
#include <lodestar/scene/deform.hpp>
#include <lodestar/scene/mesh_lods.hpp>
#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

/// Clusters drawn with the same pipeline stand together, in this order.
enum class DrawBin { opaque, opaqueDoubleSided, masked, maskedDoubleSided };
inline constexpr std::size_t kDrawBins = 4;

/// Parts of the table of clusters that triangle ids name.
enum class TablePart {
    whole,  ///< every meshlet at the finest level, by the same numbers always
    eye,    ///< what the view culled last lists
    light,  ///< the same, for views that are culled between the eye's and its last reader
};

/// What shaders need to know about a scene when they are compiled (specialization constants), so
/// that a scene pays only for what it has.
struct SceneFeatures {
    /// Which texture arrays the materials' textures of each kind lie in, a bit an array.
    std::uint32_t baseColorArrays = 0, normalArrays = 0, metallicRoughnessArrays = 0,
                  occlusionArrays = 0, emissiveArrays = 0;
    bool occlusionShared = false;  ///< occlusion is always r of the metallic-roughness texture
    bool emissive = false;
    bool uvTransforms = false;  ///< or a second UV set, wrap modes but repeat, nearest filtering
    bool secondUvs = false;
    bool unlit = false;
    bool punctualLights = false;
    bool blended = false;  ///< something is seen through
};

/// The most a view can list, whatever the scene holds: what the lists of a frame may take in
/// memory. What does not fit is left out and counted (geometry::CullCounts).
inline constexpr std::uint64_t kMaxVisibleClusters = 1 << 21;
inline constexpr std::uint64_t kMaxVisibleTriangles = 1 << 25;

/// What geometry::Tessellate makes of displaced meshes, and of what: places after the scene's own
/// vertices, triangles and meshlets, and the tables by which culling finds them.
struct Relief {
    gpu::TexelBuffer displaced;  ///< GpuDisplaced; the first is that of instances that are not
    gpu::TexelBuffer pairs;      ///< GpuDisplacedPair
    gpu::TexelBuffer refined;    ///< GpuRefined for each of `displaced`
    gpu::TexelBuffer masks;      ///< of each pair: its triangles that others stand for, 4 words
    std::uint32_t instances = 0, pairCount = 0;  ///< pairs with the unused one
    std::uint32_t firstVertex = 0, firstTriangle = 0, firstMeshlet = 0, firstListed = 0;
    std::uint32_t capacity = 0;  ///< triangles that can be refined at a time
};

/// A scene in GPU memory: vertices, levels of detail, meshlets, instances, materials, texture
/// arrays.
class GpuScene {
public:
    /// Builds (or finds in the cache) the levels of detail, builds the texture mips and uploads
    /// everything. `progress` (may be empty) hears of each step: what, done, of how many. Throws
    /// std::invalid_argument for more than LS_MAX_INSTANCES instances.
    GpuScene(const gpu::Device&, const Scene&,
             const std::function<void(const char*, int, int)>& progress = {},
             const LodSettings& lods = {});

    /// Moves the instances to where the animation has them at `seconds`, and the vertices of those
    /// that deform. Waits for the device; returns what it took there to deform them.
    gpu::FrameTimes animate(float seconds);
    bool animated() const { return !source->animations.empty(); }

    const Scene& scene() const { return *source; }
    const SceneFeatures& features() const { return sceneFeatures; }
    const Bounds& bounds() const { return worldBox; }
    const std::vector<glm::mat4>& nodeTransforms() const { return pose.worldFromNode; }
    /// Vertices that animate() writes are the last ones, from this number on.
    std::uint32_t firstDeformed() const { return deformedFrom; }
    std::uint32_t vertexCount() const { return verticesStored; }
    bool deforms() const { return deformedFrom < verticesStored; }
    /// Counts the animate() calls that moved something: what depends on geometry can be kept while
    /// this stays.
    std::uint64_t version() const { return changes; }

    /// Meshlets and triangles of all instances at the finest level.
    std::uint64_t clusterCount() const { return clustersDrawn; }
    std::uint64_t triangleCount() const { return trianglesDrawn; }
    /// Places in a part of `clusters`, and an unused one; triangles a view can list.
    std::uint32_t clusterCapacity() const;
    std::uint32_t triangleCapacity() const;
    /// Number of the first cluster of a part; of the whole, each bin's first, and the end.
    std::uint32_t tableStart(TablePart) const;
    const std::array<std::uint32_t, kDrawBins + 1>& wholeBinStarts() const { return wholeBins; }
    std::size_t lodCount() const { return lodsMost; }  ///< of the mesh that has most
    std::uint32_t instanceCount() const {
        return static_cast<std::uint32_t>(source->instances.size());
    }
    std::uint32_t chunkCount() const { return bins.back(); }
    /// First chunk of instances of each bin; the last entry is chunkCount().
    const std::array<std::uint32_t, kDrawBins + 1>& binStarts() const { return bins; }
    std::uint32_t lightCount() const { return lightsUsed; }

    gpu::TexelBuffer vertices, attributes, triangles, meshlets, instances, materials, meshes, lods,
        chunks;                        ///< the records of gpu_types.h
    gpu::TexelBuffer meshletVertices;  ///< numbers of the vertices of each meshlet
    gpu::TexelBuffer drawOrder;        ///< numbers of the instances, those of a chunk together
    /// What ids name: GpuCluster records, the parts of TablePart one after another. Those of the
    /// eye and of lights are written on the device by geometry::Cull for each view, so whoever
    /// reads ids of one must do so before another view is culled into the same part.
    gpu::TexelBuffer clusters;
    Relief relief;
    gpu::TexelBuffer secondUvs;  ///< vec2 a vertex; a dummy where no material uses them
    gpu::Buffer lights;
    std::vector<gpu::Image> textureArrays;  ///< at least one, so that bindings are never empty

    std::vector<gpu::View> textureViews() const;

private:
    struct Packed;
    GpuScene(const gpu::Device&, const Scene&, Packed&&);
    std::vector<shared::GpuInstance> packInstances() const;
    std::vector<shared::GpuChunk> packChunks() const;
    std::vector<shared::GpuLight> packLights() const;
    /// Bounds of what deforms, in the space of the instance.
    void moveSpheres();

    const Scene* source;
    Pose pose;
    Bounds worldBox;
    SceneFeatures sceneFeatures;
    std::array<std::uint32_t, kDrawBins + 1> bins{};
    std::vector<std::uint32_t> order;        ///< what drawOrder holds
    std::vector<std::uint32_t> displacedOf;  ///< GpuInstance::displaced, where any is
    std::array<std::uint32_t, kDrawBins + 1> wholeBins{};
    std::vector<glm::uvec2> chunkSpans;  ///< first and count of each chunk, in `order`
    /// GpuMesh of each instance: the number of its mesh, but for those that deform, which have
    /// geometry of their own.
    std::vector<std::uint32_t> meshOf;
    std::vector<shared::GpuMesh> packedMeshes;  ///< where some deform
    std::uint32_t deformedFrom = 0, verticesStored = 0;
    std::unique_ptr<Deform> deform;
    std::uint64_t clustersDrawn = 0, trianglesDrawn = 0;
    std::size_t lodsMost = 1;
    std::uint32_t lightsUsed = 0;
    std::uint64_t changes = 0;
};

}  // namespace lodestar::scene

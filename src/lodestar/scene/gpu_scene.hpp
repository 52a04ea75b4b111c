// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>

#include <lodestar/scene/gpu_types.h>
#include <lodestar/gpu/buffer.hpp>
#include <lodestar/gpu/image.hpp>
#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

/// Clusters drawn with the same pipeline stand together, in this order.
enum class DrawBin { opaque, opaqueDoubleSided, masked, maskedDoubleSided };
inline constexpr std::size_t kDrawBins = 4;

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
};

/// A scene in GPU memory: vertices, meshlets, instances, clusters, materials, texture arrays.
class GpuScene {
public:
    /// Cuts the meshes into meshlets, builds the texture mips and uploads everything.
    /// `progress` (may be empty) hears of each step: what, done, of how many.
    GpuScene(const gpu::Device&, const Scene&,
             const std::function<void(const char*, int, int)>& progress = {});

    /// Moves the instances to where the animation has them at `seconds`. Waits for the device.
    void animate(float seconds);
    bool animated() const { return !source->animations.empty(); }

    const Scene& scene() const { return *source; }
    const SceneFeatures& features() const { return sceneFeatures; }
    const Bounds& bounds() const { return worldBox; }
    const std::vector<glm::mat4>& nodeTransforms() const { return worldFromNodes; }
    /// Counts the animate() calls that moved something: what depends on geometry can be kept while
    /// this stays.
    std::uint64_t version() const { return changes; }

    std::uint32_t clusterCount() const { return clustersUsed; }  ///< including the unused cluster 0
    std::uint32_t triangleCount() const { return trianglesDrawn; }  ///< of all clusters
    std::uint32_t instanceCount() const {
        return static_cast<std::uint32_t>(source->instances.size());
    }
    /// First cluster of each bin; the last entry is clusterCount().
    const std::array<std::uint32_t, kDrawBins + 1>& binStarts() const { return bins; }
    std::uint32_t lightCount() const { return lightsUsed; }

    gpu::TexelBuffer vertices, attributes, triangles, meshlets, instances,
        clusters,
        materials;               ///< the records of gpu_types.h
    gpu::TexelBuffer secondUvs;  ///< vec2 a vertex; a dummy where no material uses them
    gpu::Buffer lights;
    std::vector<gpu::Image> textureArrays;  ///< at least one, so that bindings are never empty

    std::vector<gpu::View> textureViews() const;

private:
    struct Packed;
    GpuScene(const gpu::Device&, const Scene&, Packed&&);
    std::vector<shared::GpuInstance> packInstances() const;
    std::vector<shared::GpuLight> packLights() const;

    const Scene* source;
    std::vector<glm::mat4> worldFromNodes;
    Bounds worldBox;
    SceneFeatures sceneFeatures;
    std::array<std::uint32_t, kDrawBins + 1> bins{};
    std::uint32_t clustersUsed = 0, trianglesDrawn = 0, lightsUsed = 0;
    std::uint64_t changes = 0;
};

}  // namespace lodestar::scene

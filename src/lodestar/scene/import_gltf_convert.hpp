// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include <lodestar/scene/import_gltf_document.hpp>
#include <lodestar/scene/scene.hpp>

/// The second half of the glTF importer: a vetted Document → Scene.
namespace lodestar::scene::gltf {

/// Gathers what the renderer does not do, to be said once each with a count.
class Notes {
public:
    /// One more case of `what`; `{}` in it becomes the number of cases.
    void count(const std::string& what) { ++counts[what]; }
    std::vector<std::string> sentences() const;

private:
    std::map<std::string, std::size_t> counts;
};

struct Conversion {
    Document& document;
    const tinygltf::Model& model;
    Scene& scene;
    Notes& notes;
    bool usesDefaultMaterial = false;  ///< some primitive has none: it gets the one past the last
};

/// Fills Scene::materials, ::textures and ::images.
void convertMaterials(Conversion&);

/// Decodes these images of the document, on all cores. PNG and JPEG only: stb_image reads more, but
/// glTF does not allow more, and its other decoders are not fit for hostile files.
std::vector<Image> decodeImages(Document&, const std::vector<std::size_t>& images);

/// A mesh as one node shows it. Where nothing moves its joints and weights, vertices depend on the
/// skin and the weights.
struct MeshUse {
    std::size_t mesh = 0;
    std::optional<std::size_t> skin;
    bool deforms = false;
    std::vector<float> weights;  ///< of one that does not deform
    auto operator<=>(const MeshUse&) const = default;
};

struct ConvertedPrimitive {
    std::uint32_t mesh = 0;  ///< in Scene::meshes
    bool skinned = false;    ///< joints place its vertices in the world
};

/// Appends the triangle primitives of a mesh to Scene::meshes. `jointMatrices` are those of the
/// use's skin at rest, worldFromJoint · jointFromBind.
std::vector<ConvertedPrimitive> convertMesh(Conversion&, const MeshUse&,
                                            const std::vector<glm::mat4>& jointMatrices);

/// A primitive under KHR_draco_mesh_compression.
struct DracoPrimitive {
    std::vector<std::uint32_t> indices;
    std::size_t vertexCount = 0;
    /// All values of each attribute in the extension's list; components as in its accessor.
    std::map<std::string, std::vector<float>> attributes;
};
DracoPrimitive decodeDraco(Document&, const Place& primitive);

/// Nodes, instances (with the meshes they show), lights and cameras of the default scene.
void convertNodes(Conversion&);
/// Scene::animations. `sceneNodes[i]` is the Scene::nodes entry of the document's node i, or kNone.
void convertAnimations(Conversion&, const std::vector<std::uint32_t>& sceneNodes);

}  // namespace lodestar::scene::gltf

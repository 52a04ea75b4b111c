// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

/// A scene in memory, as the importers and the procedural builders make it: right-handed, y up,
/// glTF units (metres, radians), colour factors linear, texture images as they are in the file.
namespace lodestar::scene {

inline constexpr std::uint32_t kNone = 0xffffffffu;

/// Axis-aligned box [scene units]; empty when any lower > upper.
struct Bounds {
    glm::vec3 lower{1e30f};
    glm::vec3 upper{-1e30f};

    bool empty() const { return lower.x > upper.x || lower.y > upper.y || lower.z > upper.z; }
    glm::vec3 centre() const { return 0.5f * (lower + upper); }
    /// Half of the diagonal: the radius of the sphere about the box.
    float radius() const { return empty() ? 0.0f : 0.5f * glm::length(upper - lower); }
    void add(glm::vec3 point);
    void add(const Bounds& other);
    /// The box about this box after an affine transform.
    Bounds transformed(const glm::mat4& transform) const;
};

struct Vertex {
    glm::vec3 position{0};
    glm::vec3 normal{0, 0, 1};      ///< unit length
    glm::vec4 tangent{1, 0, 0, 1};  ///< unit length; w = ±1, bitangent = w · cross(normal, tangent)
    glm::vec2 uv0{0}, uv1{0};       ///< glTF convention: (0, 0) is the image's top left
    glm::vec4 color{1};             ///< linear, multiplies the base colour
};

/// Relief finer than the mesh, for near views: gradient noise along the normals, octave by octave
/// as the eye draws near (scene/displacement.h).
struct Displacement {
    float amplitude = 0;  ///< the most a point moves, outwards or inwards [object units]
    /// Of the first octave, twice that of the second [object units]; one to two edges of the mesh.
    float wavelength = 1;
    std::uint32_t octaves = 3;  ///< 1 … 3
};

/// One joint's part in a vertex.
struct Influence {
    std::uint32_t joint = 0;  ///< of the instance's skin
    float weight = 0;
};

/// What a morph target of weight 1 adds to the vertices. Each list is empty or one a vertex.
struct MorphTarget {
    std::vector<glm::vec3> position, normal, tangent;
    Bounds bounds;  ///< of `position`
};

/// One triangle list with one material (a glTF primitive).
struct Mesh {
    std::string name;
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t>
        indices;                 ///< three a triangle, counter-clockwise seen from the front
    std::uint32_t material = 0;  ///< always valid: the importer adds a default material
    Bounds bounds;               ///< of the vertices in use, object space
    std::optional<Displacement> displacement;

    /// Joints of a vertex, of instances that have a skin; the weights of each vertex are ≥ 0 and
    /// add up to 1. 0 = the mesh has no joints.
    std::uint32_t jointsPerVertex = 0;
    std::vector<Influence> influences;  ///< `jointsPerVertex` a vertex
    std::vector<Bounds> jointBounds;    ///< of the vertices that each joint moves
    std::vector<MorphTarget> targets;

    bool deforms() const { return jointsPerVertex > 0 || !targets.empty(); }
    /// Fills `jointBounds` and the targets' bounds from the vertices. Call it when they are set.
    void boundDeformation();

    /// The box about all that is ever shown of it in its rest pose, object space.
    Bounds reach() const;
};

/// 8-bit RGBA, rows from the top.
struct Image {
    std::string name;
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
};

enum class ColorSpace { linear, srgb };
enum class Wrap { repeat, mirroredRepeat, clampToEdge };

/// An image together with how it is read. The same image read in two ways is two textures.
struct Texture {
    std::uint32_t image = 0;
    ColorSpace space = ColorSpace::linear;
    Wrap wrapU = Wrap::repeat, wrapV = Wrap::repeat;
    bool nearest = false;  ///< magnify without interpolation
};

/// A material's use of a texture. `texture` is kNone where there is none.
struct TextureUse {
    std::uint32_t texture = kNone;
    std::uint32_t uvSet = 0;                  ///< 0 or 1
    glm::mat3x2 transform{1, 0, 0, 1, 0, 0};  ///< texture uv = transform · (u, v, 1)
};

enum class AlphaMode { opaque, mask, blend };

struct Material {
    std::string name;
    glm::vec4 baseColor{1};  ///< linear
    float metallic = 1;
    float roughness = 1;
    glm::vec3 emissive{0};  ///< linear, KHR_materials_emissive_strength multiplied in
    float normalScale = 1;
    float occlusionStrength = 1;
    AlphaMode alphaMode = AlphaMode::opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false;
    bool unlit = false;
    TextureUse baseColorTexture;          ///< sRGB, alpha linear
    TextureUse normalTexture;             ///< tangent space
    TextureUse metallicRoughnessTexture;  ///< g = roughness, b = metallic
    TextureUse occlusionTexture;          ///< r
    TextureUse emissiveTexture;           ///< sRGB
};

/// A local transform: either translation/rotation/scale (which animation can move) or a matrix.
struct Node {
    std::string name;
    std::uint32_t parent = kNone;  ///< always an earlier node of Scene::nodes, or kNone
    bool hasMatrix = false;
    glm::mat4 matrix{1};
    glm::vec3 translation{0};
    glm::quat rotation{1, 0, 0, 0};
    glm::vec3 scale{1};
    std::vector<float> weights;  ///< at rest, of the morph targets of what it shows
};

/// The nodes that hold a mesh, and where its vertices are in the space of each.
struct Skin {
    std::string name;
    std::vector<std::uint32_t> joints;     ///< nodes
    std::vector<glm::mat4> jointFromBind;  ///< one a joint: glTF's inverse bind matrices
};

struct Instance {
    std::uint32_t mesh = 0;
    std::uint32_t node = 0;
    glm::mat4 nodeFromObject{1};  ///< identity but for EXT_mesh_gpu_instancing
    /// Joints place the vertices in the world: `node` is one that stays at its origin.
    std::uint32_t skin = kNone;
    std::uint32_t weightsNode = kNone;  ///< the node whose weights morph it
};

enum class LightKind { directional, point, spot };

/// KHR_lights_punctual. Shines along the node's −z; the node gives its position.
struct Light {
    std::string name;
    LightKind kind = LightKind::directional;
    std::uint32_t node = 0;
    glm::vec3 color{1};                             ///< linear
    float intensity = 1;                            ///< lux for directional, candela for the others
    float range = 0;                                ///< scene units; 0 = no limit
    float innerCone = 0, outerCone = 0.785398163f;  ///< radians
};

struct SceneCamera {
    std::string name;
    std::uint32_t node = 0;    ///< looks along the node's −z
    float verticalFov = 0.8f;  ///< radians; orthographic cameras become a perspective one
    float nearPlane = 0.01f;   ///< scene units
};

enum class AnimationPath { translation, rotation, scale, weights };
enum class Interpolation { step, linear, cubicSpline };

struct AnimationChannel {
    std::uint32_t node = 0;
    AnimationPath path = AnimationPath::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;       ///< seconds, strictly increasing
    std::vector<glm::vec4> values;  ///< one a time, three (in-tangent, value, out-tangent) for
                                    ///< cubicSpline; quaternions as x, y, z, w
    std::vector<float> weights;     ///< instead of `values`, a run of the node's weights for each
};

struct Animation {
    std::string name;
    float duration = 0;  ///< seconds
    std::vector<AnimationChannel> channels;
};

struct Scene {
    std::string name;  ///< the file name, or `builtin:…`
    std::vector<Mesh> meshes;
    std::vector<Image> images;
    std::vector<Texture> textures;
    std::vector<Material> materials;  ///< never empty when there are meshes
    std::vector<Node> nodes;          ///< parents before children
    std::vector<Instance> instances;
    std::vector<Skin> skins;
    std::vector<Light> lights;
    std::vector<SceneCamera> cameras;
    std::vector<Animation> animations;
    /// What the file asks for and the renderer does not do, one sentence each ("2 skins: shown in
    /// rest pose"). Never an error: those end the import.
    std::vector<std::string> notes;
};

/// Where everything is at one moment.
struct Pose {
    std::vector<glm::mat4> worldFromNode;
    std::map<std::uint32_t, std::vector<float>> weights;  ///< of the nodes that have some
    bool operator==(const Pose&) const = default;
};

/// The scene at `seconds` of the first animation (all channels loop over its duration). A scene
/// without animation gives its rest pose. Defined in animation.cpp.
Pose poseAt(const Scene&, float seconds = 0);
/// Its matrices alone.
std::vector<glm::mat4> worldFromNode(const Scene&, float seconds = 0);

/// Whether the instance has vertices of its own, which joints or weights move.
bool deforms(const Scene&, const Instance&);

/// Box of an instance in the space of its mesh, or in the world where it has a skin. One that
/// deforms lies inside, and seldom fills it: a vertex is a weighted mean of where its joints would
/// have it, so it lies in the box about the boxes of what each joint moves, carried along by it.
Bounds objectBounds(const Scene&, const Instance&, const Pose&);
/// World box of all instances for the given node matrices (weights at rest). Empty for a scene
/// without triangles.
Bounds worldBounds(const Scene&, const std::vector<glm::mat4>& worldFromNode);
Bounds worldBounds(const Scene&, const Pose&);

/// Triangles summed over the meshes (stored) and over the instances (drawn).
struct TriangleCounts {
    std::uint64_t stored = 0, drawn = 0;
};
TriangleCounts countTriangles(const Scene&);

}  // namespace lodestar::scene

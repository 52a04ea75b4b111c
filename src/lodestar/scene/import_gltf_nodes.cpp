// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <lodestar/scene/import_gltf_convert.hpp>

namespace lodestar::scene::gltf {

namespace {

glm::quat unitRotation(glm::vec4 xyzw) {
    const float length = glm::length(xyzw);
    if (!(length > 1e-20f) || !std::isfinite(length)) return {1, 0, 0, 0};
    return glm::quat(xyzw.w / length, xyzw.x / length, xyzw.y / length, xyzw.z / length);
}

Node nodeOf(const tinygltf::Node& source) {
    Node node;
    node.name = cleaned(source.name);
    if (source.matrix.size() == 16) {
        node.hasMatrix = true;
        node.matrix = glm::mat4(glm::make_mat4(source.matrix.data()));
    }
    if (source.translation.size() == 3)
        node.translation = glm::make_vec3(source.translation.data());
    if (source.rotation.size() == 4)
        node.rotation = unitRotation(glm::make_vec4(source.rotation.data()));
    if (source.scale.size() == 3) node.scale = glm::make_vec3(source.scale.data());
    return node;
}

glm::mat4 localMatrix(const Node& node) {
    if (node.hasMatrix) return node.matrix;
    return glm::scale(
        glm::translate(glm::mat4(1), node.translation) * glm::mat4_cast(node.rotation), node.scale);
}

bool isFinite(const glm::mat4& m) {
    const float* values = glm::value_ptr(m);
    return std::all_of(values, values + 16, [](float v) { return std::isfinite(v); });
}

/// Roots of the default scene: that of "scene", else the first; without scenes all root nodes.
std::vector<int> sceneRoots(const tinygltf::Model& model) {
    if (!model.scenes.empty())
        return model.scenes[static_cast<std::size_t>(std::max(model.defaultScene, 0))].nodes;
    std::vector<bool> isChild(model.nodes.size());
    for (const tinygltf::Node& node : model.nodes)
        for (const int child : node.children) isChild[static_cast<std::size_t>(child)] = true;
    std::vector<int> roots;
    for (std::size_t i = 0; i < model.nodes.size(); ++i)
        if (!isChild[i]) roots.push_back(static_cast<int>(i));
    return roots;
}

class NodeConverter {
public:
    explicit NodeConverter(Conversion& conversion) : c(conversion) {}
    void convert();

private:
    void addHierarchy();
    void addTrees(std::vector<int> roots);
    void addWeights();
    void findMoved();
    void computeRestPose();
    std::vector<glm::mat4> jointMatrices(std::size_t skin);
    std::uint32_t skinFor(std::size_t skin);
    bool deforms(std::size_t node) const;
    void addMesh(std::size_t node);
    const std::vector<ConvertedPrimitive>& meshFor(const MeshUse&);
    std::vector<glm::mat4> gpuInstances(const Place& instancing);
    void addLight(std::size_t node);
    void addCamera(std::size_t node, const Bounds& sceneBounds);
    std::uint32_t skinnedNode();

    Conversion& c;
    std::vector<std::uint32_t> sceneNodes;  ///< Scene::nodes entry of a document's node
    std::vector<std::size_t> order;         ///< document's nodes, parents first
    std::size_t shown = 0;                  ///< of them are the scene's, the rest hold joints
    std::vector<bool> visible;              ///< of all document's nodes
    std::vector<glm::mat4> restWorld;       ///< of all document's nodes, in the scene or not
    std::vector<bool> moved, morphed;       ///< of Scene::nodes: by the animation
    std::map<MeshUse, std::vector<ConvertedPrimitive>> meshes;
    std::map<std::size_t, std::uint32_t> skins;  ///< Scene::skins entry of a document's skin
    std::uint32_t skinnedRoot = kNone;
};

void NodeConverter::addTrees(std::vector<int> pending) {
    std::reverse(pending.begin(), pending.end());
    while (!pending.empty()) {
        const auto index = static_cast<std::size_t>(pending.back());
        pending.pop_back();
        if (sceneNodes[index] != kNone) continue;
        const tinygltf::Node& source = c.model.nodes[index];
        sceneNodes[index] = static_cast<std::uint32_t>(order.size());
        order.push_back(index);
        c.scene.nodes.push_back(nodeOf(source));
        pending.insert(pending.end(), source.children.rbegin(), source.children.rend());
    }
}

/// The nodes of the scene, then those that hold joints elsewhere.
void NodeConverter::addHierarchy() {
    sceneNodes.assign(c.model.nodes.size(), kNone);
    addTrees(sceneRoots(c.model));
    shown = order.size();
    std::vector<int> parents(c.model.nodes.size(), -1);
    for (std::size_t i = 0; i < c.model.nodes.size(); ++i)
        for (const int child : c.model.nodes[i].children)
            parents[static_cast<std::size_t>(child)] = static_cast<int>(i);
    for (const tinygltf::Skin& skin : c.model.skins) {
        int root = skin.joints.front();  // they have a common one
        if (sceneNodes[static_cast<std::size_t>(root)] != kNone) continue;
        while (parents[static_cast<std::size_t>(root)] >= 0)
            root = parents[static_cast<std::size_t>(root)];
        addTrees({root});
    }
    for (const std::size_t index : order)
        for (const int child : c.model.nodes[index].children)
            c.scene.nodes[sceneNodes[static_cast<std::size_t>(child)]].parent = sceneNodes[index];
}

/// Weights of the morph targets of what the nodes show.
void NodeConverter::addWeights() {
    for (const std::size_t index : order) {
        const tinygltf::Node& source = c.model.nodes[index];
        if (source.mesh < 0) continue;
        const tinygltf::Mesh& mesh = c.model.meshes[static_cast<std::size_t>(source.mesh)];
        if (mesh.primitives.empty() || mesh.primitives.front().targets.empty()) continue;
        const std::vector<double>& weights = source.weights.empty() ? mesh.weights : source.weights;
        std::vector<float>& own = c.scene.nodes[sceneNodes[index]].weights;
        const std::size_t count = mesh.primitives.front().targets.size();
        c.document.spend(count * sizeof(float), placeOf("nodes", index));
        own.assign(weights.begin(), weights.end());
        own.resize(count, 0.0f);
    }
}

/// What the first animation, which is the one that plays, moves.
void NodeConverter::findMoved() {
    const std::vector<Node>& nodes = c.scene.nodes;
    moved.assign(nodes.size(), false);
    morphed.assign(nodes.size(), false);
    if (c.scene.animations.empty()) return;
    for (const AnimationChannel& channel : c.scene.animations.front().channels)
        (channel.path == AnimationPath::weights ? morphed : moved)[channel.node] = true;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes[i].parent != kNone && moved[nodes[i].parent]) moved[i] = true;
}

void NodeConverter::computeRestPose() {
    const std::size_t count = c.model.nodes.size();
    restWorld.assign(count, glm::mat4(1));
    visible.assign(count, true);
    std::vector<bool> isChild(count);
    for (const tinygltf::Node& node : c.model.nodes)
        for (const int child : node.children) isChild[static_cast<std::size_t>(child)] = true;
    std::vector<std::size_t> pending;
    for (std::size_t i = 0; i < count; ++i)
        if (!isChild[i]) pending.push_back(i);
    const Place nodes = c.document.root().get("nodes");
    while (!pending.empty()) {
        const std::size_t i = pending.back();
        pending.pop_back();
        restWorld[i] = restWorld[i] * localMatrix(nodeOf(c.model.nodes[i]));
        if (!isFinite(restWorld[i])) nodes[i].refuse("its place in the world is not finite");
        if (const std::optional<Place> visibility = nodes[i].extension("KHR_node_visibility"))
            if (const std::optional<Place> shown = visibility->find("visible"))
                visible[i] = visible[i] && shown->boolean();
        for (const int childIndex : c.model.nodes[i].children) {
            const auto child = static_cast<std::size_t>(childIndex);
            restWorld[child] = restWorld[i];
            visible[child] = visible[i];
            pending.push_back(child);
        }
    }
}

std::vector<glm::mat4> NodeConverter::jointMatrices(std::size_t skinIndex) {
    const tinygltf::Skin& skin = c.model.skins[skinIndex];
    std::vector<float> inverseBind;
    if (skin.inverseBindMatrices >= 0)
        inverseBind = readFloats(c.document, static_cast<std::size_t>(skin.inverseBindMatrices));
    std::vector<glm::mat4> matrices;
    c.document.spend(skin.joints.size() * sizeof(glm::mat4), placeOf("skins", skinIndex));
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        const glm::mat4& world = restWorld[static_cast<std::size_t>(skin.joints[j])];
        matrices.push_back(
            inverseBind.empty() ? world : world * glm::make_mat4(inverseBind.data() + 16 * j));
    }
    return matrices;
}

std::uint32_t NodeConverter::skinFor(std::size_t index) {
    const auto next = static_cast<std::uint32_t>(c.scene.skins.size());
    const auto [known, isNew] = skins.emplace(index, next);
    if (!isNew) return known->second;
    const tinygltf::Skin& source = c.model.skins[index];
    Skin& skin = c.scene.skins.emplace_back();
    skin.name = cleaned(source.name);
    std::vector<float> inverseBind;
    if (source.inverseBindMatrices >= 0)
        inverseBind = readFloats(c.document, static_cast<std::size_t>(source.inverseBindMatrices));
    c.document.spend(source.joints.size() * sizeof(glm::mat4), placeOf("skins", index));
    for (std::size_t j = 0; j < source.joints.size(); ++j) {
        skin.joints.push_back(sceneNodes[static_cast<std::size_t>(source.joints[j])]);
        skin.jointFromBind.push_back(
            inverseBind.empty() ? glm::mat4(1) : glm::make_mat4(inverseBind.data() + 16 * j));
    }
    return next;
}

/// Whether the animation moves the joints or the weights of what a node shows.
bool NodeConverter::deforms(std::size_t index) const {
    if (morphed[sceneNodes[index]]) return true;
    const tinygltf::Node& source = c.model.nodes[index];
    if (source.skin < 0) return false;
    const std::vector<int>& joints = c.model.skins[static_cast<std::size_t>(source.skin)].joints;
    return std::any_of(joints.begin(), joints.end(), [&](int joint) {
        return moved[sceneNodes[static_cast<std::size_t>(joint)]];
    });
}

const std::vector<ConvertedPrimitive>& NodeConverter::meshFor(const MeshUse& use) {
    const auto known = meshes.find(use);
    if (known != meshes.end()) return known->second;
    const std::vector<glm::mat4> joints =
        use.skin ? jointMatrices(*use.skin) : std::vector<glm::mat4>();
    return meshes.emplace(use, convertMesh(c, use, joints)).first->second;
}

std::vector<glm::mat4> NodeConverter::gpuInstances(const Place& instancing) {
    const std::optional<Place> attributes = instancing.find("attributes");
    std::size_t count = 0;
    const auto read = [&](const char* name) {
        const std::optional<Place> accessor =
            attributes ? attributes->find(name) : std::optional<Place>();
        if (!accessor) return std::vector<float>();
        count = c.document.accessors[accessor->whole()].count;
        return readFloats(c.document, accessor->whole());
    };
    const std::vector<float> translations = read("TRANSLATION"), rotations = read("ROTATION"),
                             scales = read("SCALE");
    c.document.spend(count * sizeof(glm::mat4), instancing.path());
    std::vector<glm::mat4> transforms(count, glm::mat4(1));
    for (std::size_t i = 0; i < count; ++i) {
        glm::mat4& m = transforms[i];
        if (!translations.empty()) m = glm::translate(m, glm::make_vec3(&translations[3 * i]));
        if (!rotations.empty())
            m *= glm::mat4_cast(unitRotation(glm::make_vec4(&rotations[4 * i])));
        if (!scales.empty()) m = glm::scale(m, glm::make_vec3(&scales[3 * i]));
        if (!isFinite(m))
            instancing.refuse(fmt::format("the transform of instance {} is not finite", i));
    }
    return transforms;
}

/// A node at the origin for all skinned meshes: joints place them, not the node they hang on.
std::uint32_t NodeConverter::skinnedNode() {
    if (skinnedRoot == kNone) {
        skinnedRoot = static_cast<std::uint32_t>(c.scene.nodes.size());
        c.scene.nodes.emplace_back().name = "skinned meshes";
    }
    return skinnedRoot;
}

void NodeConverter::addMesh(std::size_t index) {
    const tinygltf::Node& source = c.model.nodes[index];
    if (source.mesh < 0) return;
    MeshUse use;
    use.mesh = static_cast<std::size_t>(source.mesh);
    if (source.skin >= 0) use.skin = static_cast<std::size_t>(source.skin);
    use.deforms = deforms(index);
    if (!use.deforms) use.weights = c.scene.nodes[sceneNodes[index]].weights;
    c.document.spend(use.weights.size() * sizeof(float), placeOf("nodes", index));
    const std::vector<ConvertedPrimitive>& primitives = meshFor(use);
    if (primitives.empty()) return;

    std::vector<glm::mat4> transforms{glm::mat4(1)};
    const Place place = c.document.root().get("nodes")[index];
    if (const std::optional<Place> instancing = place.extension("EXT_mesh_gpu_instancing"))
        transforms = gpuInstances(*instancing);
    c.document.spend(transforms.size() * primitives.size() * sizeof(Instance), place.path());
    for (const ConvertedPrimitive& primitive : primitives) {
        Instance instance{.mesh = primitive.mesh, .node = sceneNodes[index]};
        if (use.deforms) {
            // Each has vertices of its own in the end.
            const Mesh& mesh = c.scene.meshes[primitive.mesh];
            const std::size_t copies = primitive.skinned ? 1 : transforms.size();
            for (std::size_t i = 0; i < copies; ++i)
                c.document.spend(mesh.vertices.size() * sizeof(Vertex), place.path());
            if (!mesh.targets.empty()) instance.weightsNode = instance.node;
            if (primitive.skinned) instance.skin = skinFor(*use.skin);
        }
        if (primitive.skinned) {
            instance.node = skinnedNode();
            c.scene.instances.push_back(instance);
            continue;
        }
        for (const glm::mat4& transform : transforms) {
            instance.nodeFromObject = transform;
            c.scene.instances.push_back(instance);
        }
    }
}

void NodeConverter::addLight(std::size_t index) {
    const Place node = c.document.root().get("nodes")[index];
    const std::optional<Place> extension = node.extension("KHR_lights_punctual");
    if (!extension) return;
    const tinygltf::Light& source = c.model.lights.at(extension->get("light").whole());
    Light light;
    light.name = cleaned(source.name);
    light.node = sceneNodes[index];
    light.kind = source.type == "point"  ? LightKind::point
                 : source.type == "spot" ? LightKind::spot
                                         : LightKind::directional;
    if (source.color.size() == 3)
        light.color = glm::max(glm::vec3(glm::make_vec3(source.color.data())), glm::vec3(0));
    light.intensity = std::max(static_cast<float>(source.intensity), 0.0f);
    light.range = std::max(static_cast<float>(source.range), 0.0f);
    constexpr float kWidest = 1.57079633f;
    light.outerCone = std::clamp(static_cast<float>(source.spot.outerConeAngle), 0.0f, kWidest);
    light.innerCone =
        std::clamp(static_cast<float>(source.spot.innerConeAngle), 0.0f, light.outerCone);
    c.scene.lights.push_back(light);
}

void NodeConverter::addCamera(std::size_t index, const Bounds& bounds) {
    const int cameraIndex = c.model.nodes[index].camera;
    if (cameraIndex < 0) return;
    const tinygltf::Camera& source = c.model.cameras[static_cast<std::size_t>(cameraIndex)];
    SceneCamera camera;
    camera.name = cleaned(source.name.empty() ? c.model.nodes[index].name : source.name);
    camera.node = sceneNodes[index];
    const bool perspective = source.type == "perspective";
    const double nearPlane = perspective ? source.perspective.znear : source.orthographic.znear;
    if (nearPlane > 1e-9) camera.nearPlane = static_cast<float>(nearPlane);
    double fov = source.perspective.yfov;
    if (!perspective) {
        c.notes.count("{} orthographic cameras: shown in perspective");
        // The same height in view at the distance of the scene's middle.
        const glm::dvec3 eye = restWorld[index][3];
        const double distance = bounds.empty() ? 0 : glm::length(glm::dvec3(bounds.centre()) - eye);
        fov = distance > 0 ? 2 * std::atan(std::abs(source.orthographic.ymag) / distance) : 0.8;
    }
    constexpr float kNarrowest = 0.01f, kWidest = 3.0f;
    camera.verticalFov = std::clamp(static_cast<float>(fov), kNarrowest, kWidest);
    c.scene.cameras.push_back(camera);
}

void NodeConverter::convert() {
    if (c.model.nodes.empty()) return;
    addHierarchy();
    computeRestPose();
    addWeights();
    convertAnimations(c, sceneNodes);
    findMoved();
    const std::vector<std::size_t> nodes(order.begin(),
                                         order.begin() + static_cast<std::ptrdiff_t>(shown));
    for (const std::size_t index : nodes) {
        if (!visible[index]) {
            c.notes.count("{} nodes are invisible by KHR_node_visibility: left out");
            continue;
        }
        addMesh(index);
        addLight(index);
    }
    const Bounds bounds = worldBounds(c.scene, worldFromNode(c.scene));
    for (const std::size_t index : nodes) addCamera(index, bounds);
}

}  // namespace

void convertNodes(Conversion& conversion) {
    NodeConverter(conversion).convert();
}

}  // namespace lodestar::scene::gltf

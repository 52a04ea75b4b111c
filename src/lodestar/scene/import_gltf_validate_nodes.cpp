// SPDX-License-Identifier: Apache-2.0
// The vetting of a document: nodes, scenes, skins, cameras, lights and animations.
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include <lodestar/scene/import_gltf_document.hpp>

namespace lodestar::scene::gltf {

namespace {

constexpr std::size_t kNoParent = std::numeric_limits<std::size_t>::max();

/// The node hierarchy: parents, and for each node the interval of a depth-first walk that its
/// subtree covers, so that "is below" is one comparison even in a chain of a million nodes.
struct Hierarchy {
    std::vector<std::size_t> parent, root, enter, leave;

    bool isBelow(std::size_t node, std::size_t ancestor) const {
        return root[node] == root[ancestor] && enter[ancestor] <= enter[node] &&
               leave[node] <= leave[ancestor];
    }
};

Hierarchy hierarchyOf(const std::vector<Place>& nodes) {
    Hierarchy tree;
    tree.parent.assign(nodes.size(), kNoParent);
    std::vector<std::vector<std::size_t>> children(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const Place& child : nodes[i].object().elements("children")) {
            const std::size_t c = child.index(nodes.size(), "nodes");
            if (tree.parent[c] != kNoParent)
                child.refuse(
                    fmt::format("node {} already is a child of node {}", c, tree.parent[c]));
            tree.parent[c] = i;
            children[i].push_back(c);
        }
    }
    // With at most one parent each, the nodes that no root leads to are those of cycles.
    tree.root.assign(nodes.size(), kNoParent);
    tree.enter.assign(nodes.size(), 0);
    tree.leave.assign(nodes.size(), 0);
    std::size_t clock = 0;
    struct Step {
        std::size_t node, nextChild;
    };
    for (std::size_t start = 0; start < nodes.size(); ++start) {
        if (tree.parent[start] != kNoParent) continue;
        std::vector<Step> path{{start, 0}};
        tree.root[start] = start;
        tree.enter[start] = clock++;
        while (!path.empty()) {
            Step& step = path.back();
            if (step.nextChild == children[step.node].size()) {
                tree.leave[step.node] = clock++;
                path.pop_back();
                continue;
            }
            const std::size_t child = children[step.node][step.nextChild++];
            tree.root[child] = start;
            tree.enter[child] = clock++;
            path.push_back({child, 0});
        }
    }
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (tree.root[i] == kNoParent) nodes[i].refuse("is part of a cycle of nodes");
    return tree;
}

void checkInstancing(const Document& document, const Place& instancing) {
    const std::optional<Place> attributes = instancing.find("attributes");
    if (!attributes) return;
    std::optional<std::size_t> count;
    for (const auto& [name, value] : attributes->object().json().items()) {
        const Place place = attributes->get(name);
        const Accessor& accessor =
            document.accessors[place.index(document.accessors.size(), "accessors")];
        const bool rotation = name == "ROTATION";
        if (rotation || name == "TRANSLATION" || name == "SCALE") {
            const bool packed = accessor.normalized && (accessor.componentType == kByte ||
                                                        accessor.componentType == kShort);
            if (accessor.type != (rotation ? "VEC4" : "VEC3") ||
                !(accessor.componentType == kFloat || (rotation && packed)))
                place.refuse(fmt::format("{} of component type {} is no {}", accessor.type,
                                         accessor.componentType, name));
        }
        if (!count) count = accessor.count;
        if (accessor.count != *count)
            place.refuse(
                fmt::format("{} elements where the others have {}", accessor.count, *count));
    }
}

/// Morph targets of each mesh (all of its primitives have the same number).
std::vector<std::size_t> targetCounts(const Place& root) {
    std::vector<std::size_t> counts;
    for (const Place& mesh : root.elements("meshes")) {
        const Place primitives = mesh.get("primitives");
        const std::optional<Place> targets =
            primitives.size() == 0 ? std::nullopt : primitives[0].find("targets");
        counts.push_back(targets ? targets->size() : 0);
    }
    return counts;
}

void checkNode(const Document& document, const Place& node,
               const std::vector<std::size_t>& targetsOfMeshes, std::size_t skins,
               std::size_t cameras, std::size_t lights) {
    if (const std::optional<Place> skin = node.find("skin")) skin->index(skins, "skins");
    if (const std::optional<Place> camera = node.find("camera")) camera->index(cameras, "cameras");
    if (const std::optional<Place> matrix = node.find("matrix")) matrix->numbers(16);
    if (const std::optional<Place> translation = node.find("translation")) translation->numbers(3);
    if (const std::optional<Place> rotation = node.find("rotation")) rotation->numbers(4);
    if (const std::optional<Place> scale = node.find("scale")) scale->numbers(3);
    std::size_t targets = 0;
    if (const std::optional<Place> mesh = node.find("mesh"))
        targets = targetsOfMeshes[mesh->index(targetsOfMeshes.size(), "meshes")];
    if (const std::optional<Place> weights = node.find("weights")) weights->numbers(targets);
    if (const std::optional<Place> light = node.extension("KHR_lights_punctual"))
        light->get("light").index(lights, "lights");
    if (const std::optional<Place> instancing = node.extension("EXT_mesh_gpu_instancing"))
        checkInstancing(document, *instancing);
    if (const std::optional<Place> visibility = node.extension("KHR_node_visibility"))
        if (const std::optional<Place> visible = visibility->find("visible")) visible->boolean();
}

void checkScenes(const Place& root, const Hierarchy& tree) {
    const std::vector<Place> scenes = root.elements("scenes");
    std::vector<std::size_t> listedBy(tree.parent.size(), scenes.size());
    for (std::size_t s = 0; s < scenes.size(); ++s) {
        for (const Place& node : scenes[s].object().elements("nodes")) {
            const std::size_t i = node.index(tree.parent.size(), "nodes");
            if (tree.parent[i] != kNoParent)
                node.refuse(
                    fmt::format("node {} is a child of node {}, not a root", i, tree.parent[i]));
            if (listedBy[i] == s) node.refuse(fmt::format("node {} is listed twice", i));
            listedBy[i] = s;
        }
    }
    if (const std::optional<Place> scene = root.find("scene"))
        scene->index(scenes.size(), "scenes");
}

void checkSkin(const Document& document, const Place& skin, const Hierarchy& tree) {
    const std::size_t nodes = tree.parent.size();
    const Place joints = skin.object().get("joints").array();
    if (joints.size() == 0) joints.refuse("is empty");
    constexpr std::size_t kMostJoints = 65536;  // what a vertex can name
    if (joints.size() > kMostJoints)
        joints.refuse(fmt::format("{} joints, a skin has at most {}", joints.size(), kMostJoints));
    std::optional<std::size_t> skeleton;
    if (const std::optional<Place> place = skin.find("skeleton"))
        skeleton = place->index(nodes, "nodes");
    std::optional<std::size_t> first;
    for (const Place& joint : skin.elements("joints")) {
        const std::size_t node = joint.index(nodes, "nodes");
        if (!first) first = node;
        if (tree.root[node] != tree.root[*first])
            joint.refuse(fmt::format("nodes {} and {} have no common root", *first, node));
        if (skeleton && !tree.isBelow(node, *skeleton))
            joint.refuse(
                fmt::format("node {} is not below the skeleton's node {}", node, *skeleton));
    }
    if (const std::optional<Place> matrices = skin.find("inverseBindMatrices")) {
        const Accessor& accessor =
            document.accessors[matrices->index(document.accessors.size(), "accessors")];
        if (accessor.type != "MAT4" || accessor.componentType != kFloat)
            matrices->refuse(fmt::format("{} of component type {} is no float MAT4", accessor.type,
                                         accessor.componentType));
        if (accessor.count < joints.size())
            matrices->refuse(
                fmt::format("{} matrices for {} joints", accessor.count, joints.size()));
    }
}

void checkCamera(const Place& camera) {
    const std::string& type = camera.object().get("type").text();
    if (type == "perspective") {
        const Place view = camera.get("perspective").object();
        for (const char* key : {"yfov", "znear"}) view.get(key).number();
    } else if (type == "orthographic") {
        const Place view = camera.get("orthographic").object();
        for (const char* key : {"xmag", "ymag", "znear", "zfar"}) view.get(key).number();
    } else {
        camera.get("type").refuse(fmt::format("'{}' is not a kind of camera", cleaned(type)));
    }
}

void checkLight(const Place& light) {
    const std::string& type = light.object().get("type").text();
    if (type != "directional" && type != "point" && type != "spot")
        light.get("type").refuse(fmt::format("'{}' is not a kind of light", cleaned(type)));
    if (const std::optional<Place> color = light.find("color")) color->numbers(3);
    for (const char* key : {"intensity", "range"})
        if (const std::optional<Place> member = light.find(key)) member->number();
    if (type != "spot") return;
    const Place spot = light.get("spot").object();
    for (const char* key : {"innerConeAngle", "outerConeAngle"})
        if (const std::optional<Place> member = spot.find(key)) member->number();
}

void checkAnimationSampler(const Document& document, const Place& sampler) {
    const std::size_t accessors = document.accessors.size();
    const Place input = sampler.object().get("input"), output = sampler.get("output");
    const Accessor& times = document.accessors[input.index(accessors, "accessors")];
    output.index(accessors, "accessors");
    if (times.type != "SCALAR" || times.componentType != kFloat)
        input.refuse(
            fmt::format("{} of component type {} can't be times", times.type, times.componentType));
    if (const std::optional<Place> kind = sampler.find("interpolation")) kind->text();
}

/// `targets[i]`: morph targets of what node i shows.
void checkChannel(const Document& document, const Place& channel,
                  const std::vector<Place>& samplers, const std::vector<std::size_t>& targets) {
    const std::size_t index = channel.object().get("sampler").index(samplers.size(), "samplers");
    const Place target = channel.get("target").object();
    const std::string& path = target.get("path").text();
    std::size_t each = 0;  // values of a moment
    if (const std::optional<Place> node = target.find("node"))
        each = targets[node->index(targets.size(), "nodes")];
    const bool weights = path == "weights";
    if (!weights) each = 1;
    if (path != "translation" && path != "rotation" && path != "scale" && !weights) return;
    if (each == 0) return;
    const Place sampler = samplers[index], output = sampler.get("output");
    const Accessor& values = document.accessors[output.whole()];
    const bool rotation = path == "rotation";
    const bool packed = values.normalized && values.componentType != kUnsignedInt;
    const bool typeFits = values.componentType == kFloat || ((rotation || weights) && packed);
    const char* type = rotation ? "VEC4" : weights ? "SCALAR" : "VEC3";
    if (values.type != type || !typeFits)
        output.refuse(fmt::format("{} of component type {} can't be a {}", values.type,
                                  values.componentType, path));
    const std::optional<Place> kind = sampler.find("interpolation");
    const std::size_t perTime = kind && kind->text() == "CUBICSPLINE" ? 3 : 1;
    const std::size_t times = document.accessors[sampler.get("input").whole()].count;
    if (values.count % each != 0 || values.count / each != perTime * times)
        output.refuse(
            weights ? fmt::format("{} values for {} times of {} targets", values.count, times, each)
                    : fmt::format("{} values for {} times", values.count, times));
}

}  // namespace

void validateNodes(const Document& document) {
    const Place root = document.root();
    const std::vector<Place> nodes = root.elements("nodes");
    const std::vector<std::size_t> targets = targetCounts(root);
    const std::vector<Place> skins = root.elements("skins"), cameras = root.elements("cameras");
    std::vector<Place> lights;
    if (const std::optional<Place> punctual = root.extension("KHR_lights_punctual"))
        lights = punctual->elements("lights");

    const Hierarchy tree = hierarchyOf(nodes);
    for (const Place& node : nodes)
        checkNode(document, node, targets, skins.size(), cameras.size(), lights.size());
    checkScenes(root, tree);
    for (const Place& skin : skins) checkSkin(document, skin, tree);
    for (const Place& camera : cameras) checkCamera(camera);
    for (const Place& light : lights) checkLight(light);
}

void validateAnimations(const Document& document) {
    const Place root = document.root();
    const std::vector<std::size_t> targetsOfMeshes = targetCounts(root);
    std::vector<std::size_t> targets;
    for (const Place& node : root.elements("nodes")) {
        const std::optional<Place> mesh = node.find("mesh");
        targets.push_back(mesh ? targetsOfMeshes[mesh->whole()] : 0);
    }
    for (const Place& animation : root.elements("animations")) {
        animation.object().get("channels").array();
        animation.get("samplers").array();
        const std::vector<Place> samplers = animation.elements("samplers");
        for (const Place& sampler : samplers) checkAnimationSampler(document, sampler);
        for (const Place& channel : animation.elements("channels"))
            checkChannel(document, channel, samplers, targets);
    }
}

}  // namespace lodestar::scene::gltf

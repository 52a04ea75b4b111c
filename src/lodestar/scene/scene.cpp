// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/scene.hpp>

#include <algorithm>
#include <cmath>

namespace lodestar::scene {

void Bounds::add(glm::vec3 point) {
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
}

void Bounds::add(const Bounds& other) {
    if (other.empty()) return;
    add(other.lower);
    add(other.upper);
}

Bounds Bounds::transformed(const glm::mat4& transform) const {
    if (empty()) return *this;
    const glm::vec3 half = 0.5f * (upper - lower);
    const glm::vec3 middle = transform * glm::vec4(centre(), 1);
    const glm::vec3 reach = glm::abs(glm::vec3(transform[0])) * half.x +
                            glm::abs(glm::vec3(transform[1])) * half.y +
                            glm::abs(glm::vec3(transform[2])) * half.z;
    return {middle - reach, middle + reach};
}

Bounds Mesh::reach() const {
    if (bounds.empty() || !displacement) return bounds;
    return {bounds.lower - displacement->amplitude, bounds.upper + displacement->amplitude};
}

namespace {

/// What the targets' bounds can add to a point at these weights.
Bounds morphReach(const Mesh& mesh, const std::vector<float>& weights) {
    Bounds reach{glm::vec3(0), glm::vec3(0)};
    for (std::size_t t = 0; t < std::min(weights.size(), mesh.targets.size()); ++t) {
        const Bounds& box = mesh.targets[t].bounds;
        if (box.empty()) continue;
        const glm::vec3 a = weights[t] * box.lower, b = weights[t] * box.upper;
        reach.lower += glm::min(a, b);
        reach.upper += glm::max(a, b);
    }
    return reach;
}

Bounds sum(const Bounds& a, const Bounds& b) {
    return a.empty() ? a : Bounds{a.lower + b.lower, a.upper + b.upper};
}

Bounds boundsOf(const Scene& scene, const Instance& instance,
                const std::vector<glm::mat4>& worldFromNode, const std::vector<float>* weights) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    if (!mesh.deforms()) return mesh.reach();
    const bool morphs = weights && !mesh.targets.empty();
    const Bounds reach = morphs ? morphReach(mesh, *weights) : Bounds{glm::vec3(0), glm::vec3(0)};
    Bounds box;
    float largest = 0;  // of the terms that the device adds up
    const auto add = [&](const Bounds& own, const glm::mat4& m) {
        if (own.empty()) return;
        box.add(own.transformed(m));
        const glm::vec3 far = glm::max(glm::abs(own.lower), glm::abs(own.upper));
        for (int i = 0; i < 3; ++i)
            largest = std::max(largest, std::abs(m[0][i]) * far.x + std::abs(m[1][i]) * far.y +
                                            std::abs(m[2][i]) * far.z + std::abs(m[3][i]));
    };
    if (instance.skin == kNone || mesh.jointsPerVertex == 0) {
        add(sum(mesh.bounds, reach), glm::mat4(1));
    } else {
        const Skin& skin = scene.skins[instance.skin];
        for (std::size_t j = 0; j < mesh.jointBounds.size(); ++j)
            add(sum(mesh.jointBounds[j], reach),
                worldFromNode[skin.joints[j]] * skin.jointFromBind[j]);
    }
    if (box.empty()) return box;
    const float rounding = 1e-5f * largest;
    return {box.lower - rounding, box.upper + rounding};
}

}  // namespace

void Mesh::boundDeformation() {
    jointBounds.clear();
    for (const std::uint32_t v : indices)
        for (std::uint32_t k = 0; k < jointsPerVertex; ++k) {
            const Influence& influence = influences[v * jointsPerVertex + k];
            if (!(influence.weight > 0)) continue;
            if (influence.joint >= jointBounds.size()) jointBounds.resize(influence.joint + 1);
            jointBounds[influence.joint].add(vertices[v].position);
        }
    for (MorphTarget& target : targets) {
        target.bounds = {};
        if (target.position.empty()) continue;
        for (const std::uint32_t v : indices) target.bounds.add(target.position[v]);
    }
}

bool deforms(const Scene& scene, const Instance& instance) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    return (mesh.jointsPerVertex > 0 && instance.skin != kNone) || !mesh.targets.empty();
}

Bounds objectBounds(const Scene& scene, const Instance& instance, const Pose& pose) {
    const auto weights = pose.weights.find(instance.weightsNode);
    return boundsOf(scene, instance, pose.worldFromNode,
                    weights == pose.weights.end() ? nullptr : &weights->second);
}

Bounds worldBounds(const Scene& scene, const std::vector<glm::mat4>& worldFromNode) {
    Bounds bounds;
    for (const Instance& instance : scene.instances) {
        const std::vector<float>* weights =
            instance.weightsNode == kNone ? nullptr : &scene.nodes[instance.weightsNode].weights;
        bounds.add(boundsOf(scene, instance, worldFromNode, weights)
                       .transformed(worldFromNode[instance.node] * instance.nodeFromObject));
    }
    return bounds;
}

Bounds worldBounds(const Scene& scene, const Pose& pose) {
    Bounds bounds;
    for (const Instance& instance : scene.instances)
        bounds.add(objectBounds(scene, instance, pose)
                       .transformed(pose.worldFromNode[instance.node] * instance.nodeFromObject));
    return bounds;
}

TriangleCounts countTriangles(const Scene& scene) {
    TriangleCounts counts;
    for (const Mesh& mesh : scene.meshes) counts.stored += mesh.indices.size() / 3;
    for (const Instance& instance : scene.instances)
        counts.drawn += scene.meshes[instance.mesh].indices.size() / 3;
    return counts;
}

}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/deform_reference.hpp>

namespace lodestar::scene {
namespace {

glm::dvec3 unitOr(glm::dvec3 v, glm::dvec3 otherwise) {
    const double length = glm::length(v);
    return length > 1e-30 ? v / length : otherwise;
}

glm::dmat4 jointBlend(const Mesh& mesh, const Skin& skin, const Pose& pose, std::size_t vertex) {
    glm::dmat4 m(0);
    for (std::size_t k = 0; k < mesh.jointsPerVertex; ++k) {
        const Influence& by = mesh.influences[vertex * mesh.jointsPerVertex + k];
        m += double(by.weight) * glm::dmat4(pose.worldFromNode[skin.joints[by.joint]]) *
             glm::dmat4(skin.jointFromBind[by.joint]);
    }
    return m;
}

}  // namespace

std::vector<DeformedVertex> deformReference(const Scene& scene, const Instance& instance,
                                            const Pose& pose) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const auto weights = pose.weights.find(instance.weightsNode);
    std::vector<DeformedVertex> deformed;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vertex& rest = mesh.vertices[v];
        const glm::dvec3 restTangent(rest.tangent);
        glm::dvec3 position(rest.position), normal(rest.normal), tangent = restTangent;
        for (std::size_t t = 0; weights != pose.weights.end() && t < mesh.targets.size(); ++t) {
            const MorphTarget& target = mesh.targets[t];
            const double weight = weights->second[t];
            if (!target.position.empty()) position += weight * glm::dvec3(target.position[v]);
            if (!target.normal.empty()) normal += weight * glm::dvec3(target.normal[v]);
            if (!target.tangent.empty()) tangent += weight * glm::dvec3(target.tangent[v]);
        }
        if (instance.skin != kNone && mesh.jointsPerVertex > 0) {
            const glm::dmat4 m = jointBlend(mesh, scene.skins[instance.skin], pose, v);
            const glm::dmat3 linear(m);
            position = glm::dvec3(m * glm::dvec4(position, 1));
            normal = glm::determinant(linear) == 0 ? normal
                                                   : glm::transpose(glm::inverse(linear)) * normal;
            tangent = linear * tangent;
        }
        deformed.push_back({position, unitOr(normal, rest.normal), unitOr(tangent, restTangent)});
    }
    return deformed;
}

}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/scene.hpp>

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

Bounds worldBounds(const Scene& scene, const std::vector<glm::mat4>& worldFromNode) {
    Bounds bounds;
    for (const Instance& instance : scene.instances)
        bounds.add(scene.meshes[instance.mesh].bounds.transformed(worldFromNode[instance.node] *
                                                                  instance.nodeFromObject));
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

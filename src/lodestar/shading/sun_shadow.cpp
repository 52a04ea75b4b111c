// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/sun_shadow.hpp>

#include <algorithm>
#include <cmath>

namespace lodestar::shading {
namespace {

struct Sphere {
    glm::vec3 centre{0};
    float radius = 1;
};

/// The smallest sphere about a view pyramid of the given length that is centred on its axis.
Sphere aboutView(const scene::Camera& camera, float aspect, float length) {
    const float t = std::tan(camera.verticalFov / 2);
    const float spread2 = t * t * (1 + aspect * aspect);  // (corner distance / axis distance)²
    const float along = std::min(length, length * (1 + spread2) / 2);
    const float back = length - along;
    const float radius = std::max(along, std::sqrt(back * back + length * length * spread2));
    return {camera.eye + glm::normalize(camera.at - camera.eye) * along, radius};
}

}  // namespace

SunView fitSun(glm::vec3 toSun, const scene::Bounds& bounds, const scene::Camera& camera,
               float aspect, float distance, std::uint32_t mapSize) {
    const float sceneRadius = std::max(bounds.radius(), 1e-6f);
    Sphere sphere{bounds.empty() ? glm::vec3(0) : bounds.centre(), sceneRadius};
    // A view of no depth would leave a map of no size.
    const Sphere view = aboutView(camera, aspect, std::max(distance, 1e-3f * sceneRadius));
    const bool viewOnly = view.radius < sceneRadius;
    if (viewOnly) sphere = view;

    SunView sun;
    const glm::vec3 z = glm::normalize(toSun);
    const glm::vec3 aside = std::abs(z.y) < 0.99f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    sun.right = glm::normalize(glm::cross(aside, z));
    sun.up = glm::cross(z, sun.right);

    glm::vec2 middle{glm::dot(sphere.centre, sun.right), glm::dot(sphere.centre, sun.up)};
    float radius = sphere.radius * 1.02f;
    if (viewOnly) {
        radius = std::exp2(std::ceil(std::log2(sphere.radius) * 4 + 0.5f) / 4);
        // The map is 16 steps wide, so that a step is a whole number of texels and edges stay put.
        const float step = radius / 7;
        middle = glm::round(middle / step) * step;
        radius += step;
    }
    const auto size = static_cast<float>(mapSize);
    sun.texel = 2 * radius / size;
    // Casters anywhere in the scene count, receivers too: the depth range is the scene's.
    const float front =
        glm::dot(bounds.empty() ? glm::vec3(0) : bounds.centre(), z) + sceneRadius * 1.02f;
    const float range = 2 * sceneRadius * 1.04f;
    sun.depthScale = 1 / range;

    // Rows: u, v and depth are affine in the world position; depth falls from 1 at `front`.
    const auto affine = [](glm::vec3 axis, float scale, float offset) {
        return glm::vec4(axis * scale, offset);
    };
    const glm::vec4 u = affine(sun.right, 1 / radius, -middle.x / radius);
    const glm::vec4 v = affine(sun.up, 1 / radius, -middle.y / radius);
    const glm::vec4 d = affine(z, sun.depthScale, 1 - front * sun.depthScale);
    const glm::vec4 w{0, 0, 0, 1};
    sun.clipFromWorld = glm::transpose(glm::mat4(u, -v, d, w));  // Vulkan's y points down
    const glm::vec4 half = w * (size / 2);
    sun.shadowFromWorld =
        glm::transpose(glm::mat4(u * (size / 2) + half, -v * (size / 2) + half, d, w));
    sun.up = -sun.up;  // texel v runs down
    return sun;
}

}  // namespace lodestar::shading

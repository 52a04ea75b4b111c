// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/scene.hpp>

namespace lodestar::shading {

/// An orthographic shadow map of the sun.
struct SunView {
    glm::mat4 clipFromWorld{1};    ///< reversed depth: nearest to the sun = 1
    glm::mat4 shadowFromWorld{1};  ///< world → (texel u, texel v, depth, 1)
    glm::vec3 right{1, 0, 0},
        up{0, 1, 0};       ///< of the light view, world; towards the sun = the third
    float texel = 1;       ///< [scene units]
    float depthScale = 1;  ///< depth units per scene unit

    bool operator==(const SunView&) const = default;
};

/// The sun's view of what the camera sees of `bounds`: the sphere about the scene, or, where that
/// is smaller, the sphere about the camera's view up to `distance` [scene units]. It moves in
/// steps, so that small camera moves leave it (and a map drawn with it) unchanged.
SunView fitSun(glm::vec3 toSun, const scene::Bounds& bounds, const scene::Camera& camera,
               float aspect, float distance, std::uint32_t mapSize);

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/glm.hpp>

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

/// A perspective view: infinite far plane, reversed depth (near plane → 1, infinity → 0).
struct Camera {
    glm::vec3 eye{0, 0, 1};
    glm::vec3 at{0};
    glm::vec3 up{0, 1, 0};
    float verticalFov = 0.8f;  ///< radians
    float nearPlane = 0.01f;   ///< scene units

    /// World → view: right-handed, looking along −z.
    glm::mat4 viewFromWorld() const;
    /// View → Vulkan clip space (y down, depth near/w): reversed, infinite far plane.
    /// `aspect` = width / height.
    glm::mat4 clipFromView(float aspect) const;
};

/// A view of the whole box from the front, a little above and to the right, with a small margin. An
/// empty (or not finite) box gives the view of the box from −1 to 1.
Camera frame(const Bounds&, float aspect);

/// `camera` turned by `angle` (radians, counter-clockwise seen from above) about the vertical axis
/// through `pivot`.
Camera orbited(const Camera&, glm::vec3 pivot, float angle);

/// `camera` moved towards `camera.at` by `fraction` of the distance; negative moves away. A
/// fraction of 1 or more throws std::invalid_argument.
Camera dollied(const Camera&, float fraction);

/// The view of one of the scene's cameras. `sceneRadius` gives the distance of `at`.
Camera fromSceneCamera(const SceneCamera&, const glm::mat4& worldFromNode, float sceneRadius);

}  // namespace lodestar::scene

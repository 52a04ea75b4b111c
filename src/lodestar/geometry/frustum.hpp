// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include <glm/glm.hpp>
#include <lodestar/gpu/vulkan.hpp>

namespace lodestar::geometry {

/// Left, right, bottom, top and near plane of a view with reversed depth, in world space: inside
/// where dot(plane, (p, 1)) ≥ 0. `openNear`: nothing is before the near plane. Gribb & Hartmann
/// 2001: the planes of a projection are sums of its rows.
inline std::array<glm::vec4, 5> frustumPlanes(const glm::mat4& clipFromWorld, bool openNear) {
    const auto normalised = [](glm::vec4 plane) { return plane / glm::length(glm::vec3(plane)); };
    const glm::mat4 rows = glm::transpose(clipFromWorld);
    return {normalised(rows[3] + rows[0]), normalised(rows[3] - rows[0]),
            normalised(rows[3] + rows[1]), normalised(rows[3] - rows[1]),
            openNear ? glm::vec4(0, 0, 0, 1) : normalised(rows[3] - rows[2])};
}

/// How many pixels a unit of length is at distance 1, or anywhere in a parallel view.
inline float pixelsPerUnit(const glm::mat4& clipFromWorld, vk::Extent2D size) {
    const glm::mat4 rows = glm::transpose(clipFromWorld);
    return std::max(glm::length(glm::vec3(rows[0])) * float(size.width),
                    glm::length(glm::vec3(rows[1])) * float(size.height)) /
           2;
}

}  // namespace lodestar::geometry

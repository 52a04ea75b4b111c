// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/camera.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <glm/gtc/matrix_transform.hpp>

namespace lodestar::scene {
namespace {

constexpr float kFrameFov = 0.7f;
constexpr double kFrameMargin = 1.06;  // the box leaves 3 % of the picture free on its tight sides

glm::vec3 normalizedOr(glm::vec3 v, glm::vec3 otherwise) {
    const float length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

/// An up vector that is not along `forward`.
glm::vec3 usableUp(glm::vec3 forward, glm::vec3 up) {
    up = normalizedOr(up, {0, 1, 0});
    if (glm::length(glm::cross(forward, up)) > 1e-4f) return up;
    return std::abs(forward.y) < 0.9f ? glm::vec3(0, 1, 0)
                                      : glm::vec3(0, 0, forward.y > 0 ? 1 : -1);
}

bool finite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

glm::mat4 Camera::viewFromWorld() const {
    const glm::vec3 forward = normalizedOr(at - eye, {0, 0, -1});
    return glm::lookAtRH(eye, eye + forward, usableUp(forward, up));
}

glm::mat4 Camera::clipFromView(float aspect) const {
    const float scale = 1 / std::tan(0.5f * verticalFov);
    glm::mat4 clip(0);
    clip[0][0] = scale / aspect;
    clip[1][1] = -scale;
    clip[2][3] = -1;         // w = distance along −z
    clip[3][2] = nearPlane;  // depth = near / w
    return clip;
}

Camera frame(const Bounds& bounds, float aspect) {
    Camera camera;
    camera.verticalFov = kFrameFov;
    const bool usable = !bounds.empty() && finite(bounds.lower) && finite(bounds.upper);
    const Bounds box = usable ? bounds : Bounds{glm::vec3(-1), glm::vec3(1)};

    const glm::dvec3 lower(box.lower), upper(box.upper);
    const glm::dvec3 centre = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
    // A point, or a box too small for floats at its distance from the origin, still gets a view.
    const double radius = std::max({glm::length(half), 1e-5 * glm::length(centre), 1e-6});

    const glm::dvec3 back = glm::normalize(glm::dvec3(0.45, 0.32, 1));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
    const glm::dvec3 above = glm::cross(back, right);
    const double tanY = std::tan(0.5 * kFrameFov) / kFrameMargin;
    const double tanX = tanY * (std::isfinite(aspect) && aspect > 0 ? double(aspect) : 1.0);

    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p =
            half * glm::dvec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const double needed =
            std::max(std::abs(glm::dot(p, right)) / tanX, std::abs(glm::dot(p, above)) / tanY);
        // A thin box seen end on needs no width, but must not reach through the eye.
        distance = std::max(distance, std::max(needed, 0.1 * radius) + glm::dot(p, back));
    }
    camera.at = centre;
    camera.eye = centre + back * distance;
    camera.nearPlane = static_cast<float>(std::clamp(1e-3 * radius, 1e-6, 1e4));
    return camera;
}

Camera orbited(const Camera& camera, glm::vec3 pivot, float angle) {
    const glm::mat3 turn(glm::rotate(glm::mat4(1), angle, glm::vec3(0, 1, 0)));
    Camera turned = camera;
    turned.eye = pivot + turn * (camera.eye - pivot);
    turned.at = pivot + turn * (camera.at - pivot);
    turned.up = turn * camera.up;
    return turned;
}

Camera dollied(const Camera& camera, float fraction) {
    if (!(fraction < 1)) throw std::invalid_argument("dollied: fraction must be below 1");
    Camera moved = camera;
    moved.eye += fraction * (camera.at - camera.eye);
    return moved;
}

Camera fromSceneCamera(const SceneCamera& source, const glm::mat4& worldFromNode,
                       float sceneRadius) {
    const glm::vec3 forward = normalizedOr(-glm::vec3(worldFromNode[2]), {0, 0, -1});
    Camera camera;
    camera.eye = glm::vec3(worldFromNode[3]);
    camera.at = camera.eye + forward * (sceneRadius > 0 ? sceneRadius : 1.0f);
    camera.up = usableUp(forward, glm::vec3(worldFromNode[1]));
    camera.verticalFov = std::clamp(source.verticalFov, 0.001f, std::numbers::pi_v<float> - 0.001f);
    camera.nearPlane = std::max(source.nearPlane, 1e-6f);
    return camera;
}

}  // namespace lodestar::scene

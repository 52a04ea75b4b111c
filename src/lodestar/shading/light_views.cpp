// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/light_views.hpp>

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

/// A map of `mapSize`² texels about `middle`, `radius` to each side [scene units along the axes of
/// the light]; in depth it spans the scene, which the point `centre` and `sceneRadius` bound.
struct Window {
    glm::vec3 right, up, toLight;
    glm::vec2 middle;
    float radius;
};

Window windowAbout(glm::vec3 toLight, const Sphere& sphere) {
    Window w{.toLight = glm::normalize(toLight)};
    const glm::vec3 aside = std::abs(w.toLight.y) < 0.99f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    w.right = glm::normalize(glm::cross(aside, w.toLight));
    w.up = glm::cross(w.toLight, w.right);
    w.middle = {glm::dot(sphere.centre, w.right), glm::dot(sphere.centre, w.up)};
    w.radius = sphere.radius * 1.02f;
    return w;
}

/// Casters anywhere in the scene count, receivers too: the depth range is the scene's.
LightView viewThrough(const Window& w, const Sphere& scene, std::uint32_t mapSize) {
    const auto size = static_cast<float>(mapSize);
    const float front = glm::dot(scene.centre, w.toLight) + scene.radius * 1.02f;
    const float range = 2 * scene.radius * 1.04f;
    LightView view{.toLight = w.toLight,
                   .texel = 2 * w.radius / size,
                   .size = mapSize,
                   .depthScale = 1 / range};

    // Rows: u, v and depth are affine in the world position; depth falls from 1 at `front`.
    const auto affine = [](glm::vec3 axis, float scale, float offset) {
        return glm::vec4(axis * scale, offset);
    };
    const glm::vec4 u = affine(w.right, 1 / w.radius, -w.middle.x / w.radius);
    const glm::vec4 v = affine(w.up, 1 / w.radius, -w.middle.y / w.radius);
    const glm::vec4 d = affine(w.toLight, view.depthScale, 1 - front * view.depthScale);
    const glm::vec4 one{0, 0, 0, 1};
    view.clipFromWorld = glm::transpose(glm::mat4(u, -v, d, one));  // Vulkan's y points down
    const glm::vec4 half = one * (size / 2);
    view.mapFromWorld =
        glm::transpose(glm::mat4(u * (size / 2) + half, -v * (size / 2) + half, d, one));
    return view;
}

Sphere about(const scene::Bounds& bounds) {
    return {bounds.empty() ? glm::vec3(0) : bounds.centre(), std::max(bounds.radius(), 1e-6f)};
}

}  // namespace

shared::GpuLightView LightView::params() const {
    const glm::mat4 rows = glm::transpose(mapFromWorld);
    return {.u = rows[0],
            .v = rows[1],
            .depth = rows[2],
            .toLight = toLight,
            .weight = weight,
            .bias = texel * depthScale,
            .planeScale = texel * texel * depthScale,
            .size = size};
}

LightView fitSun(glm::vec3 toSun, const scene::Bounds& bounds, const scene::Camera& camera,
                 float aspect, float distance, std::uint32_t mapSize) {
    const Sphere scene = about(bounds);
    // A view of no depth would leave a map of no size.
    const Sphere seen = aboutView(camera, aspect, std::max(distance, 1e-3f * scene.radius));
    if (seen.radius >= scene.radius) return viewThrough(windowAbout(toSun, scene), scene, mapSize);

    Window window = windowAbout(toSun, seen);
    window.radius = std::exp2(std::ceil(std::log2(seen.radius) * 4 + 0.5f) / 4);
    // The map is 16 steps wide, so that a step is a whole number of texels and edges stay put.
    const float step = window.radius / 7;
    window.middle = glm::round(window.middle / step) * step;
    window.radius += step;
    return viewThrough(window, scene, mapSize);
}

std::vector<LightView> fitSky(const Sky& sky, const scene::Bounds& bounds, std::uint32_t count,
                              std::uint32_t mapSize) {
    constexpr float kGoldenAngle = 2.39996323f;
    const Sphere scene = about(bounds);
    std::vector<LightView> views;
    for (std::uint32_t i = 0; i < count; ++i) {
        const float y = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
        const float turn = kGoldenAngle * static_cast<float>(i), s = std::sqrt(1 - y * y);
        const glm::vec3 toSky(s * std::cos(turn), y, s * std::sin(turn));
        views.push_back(viewThrough(windowAbout(toSky, scene), scene, mapSize));
        views.back().weight = glm::dot(sky.radiance(toSky), glm::vec3(0.2126f, 0.7152f, 0.0722f));
    }
    return views;
}

}  // namespace lodestar::shading

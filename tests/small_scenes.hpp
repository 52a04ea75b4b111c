// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/procedural_parts.hpp>

/// Scenes made by hand, for tests of the renderer.
namespace small_scenes {

using lodestar::scene::ColorSpace;
using lodestar::scene::Image;
using lodestar::scene::Material;
using lodestar::scene::Mesh;
using lodestar::scene::Scene;
using lodestar::scene::procedural::SceneBuilder;
namespace parts = lodestar::scene::procedural;

inline void place(Scene& scene, std::uint32_t mesh, const glm::mat4& worldFromObject) {
    const auto node = static_cast<std::uint32_t>(scene.nodes.size());
    scene.nodes.push_back({.hasMatrix = true, .matrix = worldFromObject});
    scene.instances.push_back({.mesh = mesh, .node = node});
}

/// A rectangle in the plane z = 0, 2 × 2 about the origin, seen from +z; uv (0, 0) is its top left.
inline Mesh quad(glm::vec2 repeats = {1, 1}) {
    return parts::patch(parts::rectangle({-1, 1, 0}, {2, 0, 0}, {0, -2, 0}), 1, 1, repeats);
}

/// The camera on the z axis for which quad() fills a square picture.
inline lodestar::scene::Camera facing(float distance = 8) {
    return {.eye = {0, 0, distance},
            .at = {0, 0, 0},
            .verticalFov = 2 * std::atan(1 / distance),
            .nearPlane = 0.1f};
}

/// One mesh with one material, where it was made.
inline Scene single(Mesh mesh, const Material& material = {}) {
    SceneBuilder builder("single");
    builder.place(builder.add("mesh", std::move(mesh), builder.add(material)));
    return std::move(builder).finish();
}

/// Triangles that follow one another in `corners`, each with its own normal; uv = 0, 1 and 2
/// thirds.
inline Mesh triangles(const std::vector<glm::vec3>& corners) {
    Mesh mesh;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::vec3* t = &corners[i - i % 3];
        lodestar::scene::Vertex vertex;
        vertex.position = corners[i];
        vertex.normal = glm::normalize(glm::cross(t[1] - t[0], t[2] - t[0]));
        vertex.uv0 = {float(i % 3) / 3, float(i % 2)};
        mesh.vertices.push_back(vertex);
        mesh.indices.push_back(static_cast<std::uint32_t>(i));
        mesh.bounds.add(corners[i]);
    }
    return mesh;
}

/// Uniform numbers in [lower, upper), the same on every platform.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine(seed) {}
    float operator()(float lower, float upper) {
        return lower + (upper - lower) * (float(engine() >> 8) / 16777216.0f);
    }
    glm::vec3 vec3(float lower, float upper) {
        const float x = (*this)(lower, upper), y = (*this)(lower, upper);
        return {x, y, (*this)(lower, upper)};
    }
    glm::mat4 rotation() {
        const float angle = (*this)(0, 6.28f);
        return glm::rotate(glm::mat4(1), angle, glm::normalize(vec3(-1, 1) + glm::vec3(0.01f)));
    }

private:
    std::mt19937 engine;
};

/// Spheres, knots and boxes, turned, stretched, sheared and reflected; in all four draw bins.
inline Scene jumble() {
    SceneBuilder builder("jumble");
    Material twoSided = parts::plain("two-sided", {0.7f, 0.2f, 0.2f}, 0, 0.5f);
    twoSided.doubleSided = true;
    Material masked = parts::plain("masked", {0.2f, 0.7f, 0.2f}, 0, 0.5f);
    masked.alphaMode = lodestar::scene::AlphaMode::mask;
    Material maskedTwoSided = masked;
    maskedTwoSided.doubleSided = true;
    const Mesh ball = parts::patch(parts::sphere(0.5), 64, 32, {1, 1});
    const Mesh knot = parts::patch(parts::torusKnot(0.6, 0.12), 192, 12, {1, 1});
    builder.add("ball", ball, builder.add(parts::plain("plain", {0.2f, 0.2f, 0.7f}, 0, 0.5f)));
    builder.add("knot", knot, builder.add(twoSided));
    builder.add("box", parts::box({-0.4, -0.3, -0.2}, {0.4, 0.3, 0.2}, 1), builder.add(masked));
    builder.add("masked ball", ball, builder.add(maskedTwoSided));
    Scene scene = std::move(builder).finish();

    Random random(7);
    for (std::uint32_t i = 0; i < 24; ++i) {
        glm::vec3 scale = random.vec3(0.3f, 2.5f);
        if (i % 3 == 0) scale = glm::vec3(scale.x);  // uniform: normal cones are used
        if (i / 4 % 2 == 1) scale.x = -scale.x;
        const glm::mat4 shear = i % 5 == 4 ? random.rotation() : glm::mat4(1);
        place(scene, i % 4,
              glm::translate(glm::mat4(1), random.vec3(-4, 4)) * random.rotation() *
                  glm::scale(glm::mat4(1), scale) * shear);
    }
    return scene;
}

}  // namespace small_scenes

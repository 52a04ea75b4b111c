// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <glm/glm.hpp>

#include <lodestar/scene/scene.hpp>

/// What the procedural scenes are built of.
namespace lodestar::scene::procedural {

/// A parametric surface over [0, 1]²; seen from its front, u runs to the right and v downwards. It
/// must go on smoothly a little beyond the unit square, where its derivatives are taken.
using Surface = std::function<glm::dvec3(double u, double v)>;
/// Radius and height of a surface of revolution, from its top (v = 0) to its bottom.
using Profile = std::function<glm::dvec2(double v)>;

/// `across` × `down` quads with the surface's own normals and tangents. The texture repeats
/// `repeats` times over the patch. Triangles without area (at poles) are left out.
Mesh patch(const Surface&, std::uint32_t across, std::uint32_t down, glm::vec2 repeats);
/// The same surface seen from its other side.
Surface inside(Surface);

Surface lathe(Profile);
Surface sphere(double radius);
/// A tube about a (2, 3) torus knot that fills a sphere of about `radius`.
Surface torusKnot(double radius, double tube);
/// A rectangle: `corner` is its top left seen from the front.
Surface rectangle(glm::dvec3 corner, glm::dvec3 right, glm::dvec3 down);
/// A straight tube between two points, without caps: for rods and cables.
Surface rod(glm::dvec3 from, glm::dvec3 to, double radius);

/// An axis-aligned box; its texture repeats every `metres`.
Mesh box(glm::dvec3 lower, glm::dvec3 upper, double metres);

void append(Mesh& to, const Mesh& part);
/// Texture coordinates by projection along the normal's main axis, one repeat every `metres`.
void projectUv(Mesh&, double metres);

/// A scene under construction; each `add` gives the index of what it added.
class SceneBuilder {
public:
    explicit SceneBuilder(std::string name) { scene.name = std::move(name); }

    /// A use of `image` with the default wrap, for a Material.
    TextureUse add(Image image, ColorSpace space);
    std::uint32_t add(Material material);
    std::uint32_t add(std::string name, Mesh mesh, std::uint32_t material);
    void place(std::uint32_t mesh, glm::vec3 translation = glm::vec3(0), float turn = 0,
               float scale = 1);
    void addCamera(std::string name, glm::vec3 eye, glm::vec3 at, float verticalFov);

    Scene finish() && { return std::move(scene); }

private:
    Scene scene;
};

/// A material without textures.
Material plain(std::string name, glm::vec3 color, float metallic, float roughness);

}  // namespace lodestar::scene::procedural

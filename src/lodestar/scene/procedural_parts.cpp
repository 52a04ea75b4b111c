// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/procedural_parts.hpp>

#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

namespace lodestar::scene::procedural {
namespace {

using std::numbers::pi;

constexpr double kStep = 1e-4;   // of the parameters, for derivatives
constexpr double kNudge = 1e-3;  // away from a pole, where one derivative vanishes

struct Frame {
    glm::dvec3 tangent, normal;
};

/// Tangent (along u) and normal; {0, 0} where the surface has none.
Frame frameAt(const Surface& surface, double u, double v) {
    const glm::dvec3 along = surface(u + kStep, v) - surface(u - kStep, v);
    const glm::dvec3 downwards = surface(u, v + kStep) - surface(u, v - kStep);
    const glm::dvec3 normal = glm::cross(downwards, along);
    if (glm::length(normal) <= 1e-6 * glm::dot(along + downwards, along + downwards))
        return {glm::dvec3(0), glm::dvec3(0)};
    const glm::dvec3 n = glm::normalize(normal);
    return {glm::normalize(along - n * glm::dot(n, along)), n};
}

Vertex vertexAt(const Surface& surface, double u, double v, glm::vec2 repeats) {
    Frame frame = frameAt(surface, u, v);
    if (frame.normal == glm::dvec3(0))
        frame = frameAt(surface, u, v < 0.5 ? v + kNudge : v - kNudge);
    Vertex vertex;
    vertex.position = surface(u, v);
    vertex.normal = frame.normal;
    vertex.tangent = glm::vec4(glm::vec3(frame.tangent), 1);  // v runs down, so right-handed
    vertex.uv0 = vertex.uv1 = glm::vec2(u, v) * repeats;
    return vertex;
}

}  // namespace

Mesh patch(const Surface& surface, std::uint32_t across, std::uint32_t down, glm::vec2 repeats) {
    Mesh mesh;
    for (std::uint32_t y = 0; y <= down; ++y)
        for (std::uint32_t x = 0; x <= across; ++x)
            mesh.vertices.push_back(
                vertexAt(surface, double(x) / across, double(y) / down, repeats));
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const glm::vec3 p = mesh.vertices[a].position;
        const glm::vec3 ab = mesh.vertices[b].position - p, ac = mesh.vertices[c].position - p;
        if (glm::length(glm::cross(ab, ac)) > 1e-6f * glm::dot(ab + ac, ab + ac))
            mesh.indices.insert(mesh.indices.end(), {a, b, c});
    };
    for (std::uint32_t y = 0; y < down; ++y)
        for (std::uint32_t x = 0; x < across; ++x) {
            const std::uint32_t topLeft = y * (across + 1) + x, bottomLeft = topLeft + across + 1;
            triangle(topLeft, bottomLeft, topLeft + 1);
            triangle(topLeft + 1, bottomLeft, bottomLeft + 1);
        }
    return mesh;
}

Surface inside(Surface surface) {
    return [surface = std::move(surface)](double u, double v) { return surface(1 - u, v); };
}

Surface lathe(Profile profile) {
    return [profile = std::move(profile)](double u, double v) {
        const glm::dvec2 p = profile(v);
        const double turn = 2 * pi * (u - std::floor(u));  // closed to the bit at u = 1
        return glm::dvec3(p.x * std::sin(turn), p.y, p.x * std::cos(turn));
    };
}

Surface sphere(double radius) {
    return lathe(
        [radius](double v) { return radius * glm::dvec2(std::sin(pi * v), std::cos(pi * v)); });
}

Surface torusKnot(double radius, double tube) {
    const auto curve = [scale = (radius - tube) / 3](double t) {
        const double out = 2 + std::cos(3 * t);
        return scale * glm::dvec3(out * std::cos(2 * t), out * std::sin(2 * t), -std::sin(3 * t));
    };
    return [curve, tube](double u, double v) {
        constexpr double kAhead = 1e-3;
        const double t = -2 * pi * v;
        const glm::dvec3 p = curve(t), q = curve(t + kAhead);
        const glm::dvec3 along = glm::normalize(q - p);
        const glm::dvec3 side = glm::normalize(glm::cross(along, q + p));
        const glm::dvec3 out = glm::cross(side, along);
        return p + tube * (std::cos(2 * pi * u) * out + std::sin(2 * pi * u) * side);
    };
}

Surface rectangle(glm::dvec3 corner, glm::dvec3 right, glm::dvec3 down) {
    return [=](double u, double v) { return corner + u * right + v * down; };
}

Surface rod(glm::dvec3 from, glm::dvec3 to, double radius) {
    const glm::dvec3 along = glm::normalize(to - from);
    const glm::dvec3 any = std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 side = glm::normalize(glm::cross(any, along));
    const glm::dvec3 out = glm::cross(along, side);
    return [=](double u, double v) {
        return glm::mix(from, to, v) +
               radius * (std::cos(2 * pi * u) * out + std::sin(2 * pi * u) * side);
    };
}

Mesh box(glm::dvec3 lower, glm::dvec3 upper, double metres) {
    const glm::dvec3 size = upper - lower;
    const glm::dvec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    Mesh mesh;
    for (const Surface& side :
         {rectangle(lower + y + z, x, -y), rectangle(upper - z, -x, -y), rectangle(upper, -z, -y),
          rectangle(lower + y, z, -y), rectangle(lower + y, x, z), rectangle(lower + z, x, -z)})
        append(mesh, patch(side, 1, 1, {1, 1}));
    projectUv(mesh, metres);
    return mesh;
}

void append(Mesh& to, const Mesh& part) {
    const auto first = static_cast<std::uint32_t>(to.vertices.size());
    to.vertices.insert(to.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (std::uint32_t index : part.indices) to.indices.push_back(first + index);
}

void projectUv(Mesh& mesh, double metres) {
    for (Vertex& vertex : mesh.vertices) {
        const glm::vec3 size = glm::abs(vertex.normal);
        const glm::vec3 p = vertex.position / static_cast<float>(metres);
        glm::vec3 right;  // of the texture; its up is cross(normal, right)
        if (size.y >= size.x && size.y >= size.z)
            right = {1, 0, 0};
        else if (size.x >= size.z)
            right = {0, 0, vertex.normal.x > 0 ? -1 : 1};
        else
            right = {vertex.normal.z > 0 ? 1 : -1, 0, 0};
        const glm::vec3 tangent =
            glm::normalize(right - vertex.normal * glm::dot(right, vertex.normal));
        vertex.tangent = glm::vec4(tangent, 1);
        vertex.uv0 = {glm::dot(p, right), -glm::dot(p, glm::cross(vertex.normal, tangent))};
        vertex.uv1 = vertex.uv0;
    }
}

TextureUse SceneBuilder::add(Image image, ColorSpace space) {
    Texture texture;
    texture.image = static_cast<std::uint32_t>(scene.images.size());
    texture.space = space;
    scene.images.push_back(std::move(image));
    scene.textures.push_back(texture);
    TextureUse use;
    use.texture = static_cast<std::uint32_t>(scene.textures.size() - 1);
    return use;
}

std::uint32_t SceneBuilder::add(Material material) {
    scene.materials.push_back(std::move(material));
    return static_cast<std::uint32_t>(scene.materials.size() - 1);
}

std::uint32_t SceneBuilder::add(std::string name, Mesh mesh, std::uint32_t material) {
    mesh.name = std::move(name);
    mesh.material = material;
    mesh.bounds = {};
    for (std::uint32_t index : mesh.indices) mesh.bounds.add(mesh.vertices[index].position);
    scene.meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(scene.meshes.size() - 1);
}

void SceneBuilder::place(std::uint32_t mesh, glm::vec3 translation, float turn, float scale) {
    Node node;
    node.name = scene.meshes[mesh].name;
    node.translation = translation;
    node.rotation = glm::angleAxis(turn, glm::vec3(0, 1, 0));
    node.scale = glm::vec3(scale);
    scene.nodes.push_back(std::move(node));
    scene.instances.push_back({mesh, static_cast<std::uint32_t>(scene.nodes.size() - 1)});
}

void SceneBuilder::addCamera(std::string name, glm::vec3 eye, glm::vec3 at, float verticalFov) {
    const glm::mat3 world(glm::inverse(glm::lookAtRH(eye, at, glm::vec3(0, 1, 0))));
    Node node;
    node.name = name;
    node.translation = eye;
    node.rotation = glm::quat_cast(world);
    scene.nodes.push_back(std::move(node));
    SceneCamera camera;
    camera.name = std::move(name);
    camera.node = static_cast<std::uint32_t>(scene.nodes.size() - 1);
    camera.verticalFov = verticalFov;
    camera.nearPlane = 0.05f;
    scene.cameras.push_back(std::move(camera));
}

Material plain(std::string name, glm::vec3 color, float metallic, float roughness) {
    Material material;
    material.name = std::move(name);
    material.baseColor = glm::vec4(color, 1);
    material.metallic = metallic;
    material.roughness = roughness;
    return material;
}

}  // namespace lodestar::scene::procedural

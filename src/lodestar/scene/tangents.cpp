// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/tangents.hpp>

#include <array>
#include <cmath>
#include <numeric>
#include <type_traits>

#include <meshoptimizer.h>

namespace lodestar::scene {

namespace {

/// `vector` at unit length, or `otherwise` if it has no direction. In double: squares of small and
/// large floats leave the float range.
glm::vec3 unitOr(glm::dvec3 vector, glm::vec3 otherwise) {
    const double length = glm::length(vector);
    return length > 1e-30 && std::isfinite(length) ? glm::vec3(vector / length) : otherwise;
}

glm::vec3 anyPerpendicular(glm::vec3 normal) {
    const glm::vec3 axis = std::abs(normal.x) < 0.6f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    return glm::normalize(axis - normal * glm::dot(axis, normal));
}

/// Twice the area times the normal.
glm::dvec3 faceVector(const Mesh& mesh, std::size_t firstIndex) {
    const glm::dvec3 a = mesh.vertices[mesh.indices[firstIndex]].position;
    const glm::dvec3 b = mesh.vertices[mesh.indices[firstIndex + 1]].position;
    const glm::dvec3 c = mesh.vertices[mesh.indices[firstIndex + 2]].position;
    return glm::cross(b - a, c - a);
}

std::vector<glm::dvec3> faceVectorSums(const Mesh& mesh) {
    std::vector<glm::dvec3> sums(mesh.vertices.size(), glm::dvec3(0));
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const glm::dvec3 face = faceVector(mesh, i);
        for (std::size_t k = 0; k < 3; ++k) sums[mesh.indices[i + k]] += face;
    }
    return sums;
}

struct UvFrame {
    glm::dvec3 alongU{0}, alongV{0};  ///< of the surface, scaled by the triangle's area
    double handedness = 0;            ///< > 0 not mirrored, < 0 mirrored, 0 unknown
};

UvFrame uvFrame(const std::array<glm::dvec3, 3>& p, const std::array<glm::dvec2, 3>& uv) {
    const glm::dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
    const glm::dvec2 d1 = uv[1] - uv[0], d2 = uv[2] - uv[0];
    const double det = d1.x * d2.y - d2.x * d1.y;
    UvFrame frame;
    if (det == 0 || !std::isfinite(det)) return frame;
    const double area = glm::length(glm::cross(e1, e2));
    const double sign = det > 0 ? 1 : -1;
    const glm::dvec3 u = sign * (d2.y * e1 - d1.y * e2), v = sign * (d1.x * e2 - d2.x * e1);
    if (glm::length(u) > 0) frame.alongU = area * glm::normalize(u);
    if (glm::length(v) > 0) frame.alongV = area * glm::normalize(v);
    // v runs downwards in the image, so an image that is not mirrored has a negative determinant.
    frame.handedness = -sign;
    return frame;
}

/// Gives `mesh` the vertices with these numbers, with all that belongs to them.
void gather(Mesh& mesh, const std::vector<std::uint32_t>& from) {
    const auto of = [&](auto& list, std::size_t each) {
        std::remove_reference_t<decltype(list)> gathered;
        gathered.reserve(from.size() * each);
        for (const std::uint32_t v : from)
            for (std::size_t k = 0; k < each; ++k) gathered.push_back(list[v * each + k]);
        list = std::move(gathered);
    };
    of(mesh.vertices, 1);
    if (mesh.jointsPerVertex > 0) of(mesh.influences, mesh.jointsPerVertex);
    for (MorphTarget& target : mesh.targets)
        for (auto* list : {&target.position, &target.normal, &target.tangent})
            if (!list->empty()) of(*list, 1);
}

/// Gives mirrored triangles their own copy of each vertex that unmirrored ones use as well.
void splitMirrored(Mesh& mesh, const std::vector<UvFrame>& frames) {
    constexpr std::uint8_t kPlain = 1, kMirrored = 2;
    std::vector<std::uint8_t> uses(mesh.vertices.size(), 0);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const double handedness = frames[i / 3].handedness;
        if (handedness != 0) uses[mesh.indices[i]] |= handedness > 0 ? kPlain : kMirrored;
    }
    std::vector<std::uint32_t> copyOf(mesh.vertices.size(), kNone), all(mesh.vertices.size());
    std::iota(all.begin(), all.end(), 0);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        std::uint32_t& index = mesh.indices[i];
        if (frames[i / 3].handedness >= 0 || uses[index] != (kPlain | kMirrored)) continue;
        if (copyOf[index] == kNone) {
            copyOf[index] = static_cast<std::uint32_t>(all.size());
            all.push_back(index);
        }
        index = copyOf[index];
    }
    if (all.size() > mesh.vertices.size()) gather(mesh, all);
}

}  // namespace

void weldVertices(Mesh& mesh) {
    static_assert(sizeof(Vertex) == 18 * sizeof(float), "padding would make equal vertices differ");
    if (mesh.indices.empty()) return;
    std::vector<unsigned> remap(mesh.vertices.size());
    const std::size_t count =
        meshopt_generateVertexRemap(remap.data(), mesh.indices.data(), mesh.indices.size(),
                                    mesh.vertices.data(), mesh.vertices.size(), sizeof(Vertex));
    std::vector<Vertex> vertices(count);
    meshopt_remapVertexBuffer(vertices.data(), mesh.vertices.data(), mesh.vertices.size(),
                              sizeof(Vertex), remap.data());
    meshopt_remapIndexBuffer(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(),
                             remap.data());
    mesh.vertices = std::move(vertices);
}

void generateFlatNormals(Mesh& mesh) {
    mesh.indices.resize(mesh.indices.size() / 3 * 3);
    gather(mesh, mesh.indices);
    std::iota(mesh.indices.begin(), mesh.indices.end(), 0);
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::vec3 normal = unitOr(faceVector(mesh, i), {0, 0, 1});
        for (std::size_t k = 0; k < 3; ++k) mesh.vertices[i + k].normal = normal;
    }
    if (!mesh.deforms()) {
        weldVertices(mesh);
        return;
    }
    // A face turns with its corners: exact at no and at full weight.
    for (MorphTarget& target : mesh.targets) {
        if (target.position.empty()) continue;
        target.normal.resize(mesh.vertices.size());
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const auto corner = [&](std::size_t k) {
                return glm::dvec3(mesh.vertices[i + k].position) +
                       glm::dvec3(target.position[i + k]);
            };
            const glm::vec3 normal = mesh.vertices[i].normal;
            const glm::vec3 turned =
                unitOr(glm::cross(corner(1) - corner(0), corner(2) - corner(0)), normal);
            for (std::size_t k = 0; k < 3; ++k) target.normal[i + k] = turned - normal;
        }
    }
}

void generateSmoothNormals(Mesh& mesh) {
    const std::vector<glm::dvec3> sums = faceVectorSums(mesh);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        mesh.vertices[i].normal = unitOr(sums[i], {0, 0, 1});
}

void repairNormals(Mesh& mesh) {
    constexpr glm::vec3 kBroken(0);
    bool anyBroken = false;
    for (Vertex& vertex : mesh.vertices) {
        vertex.normal = unitOr(vertex.normal, kBroken);
        anyBroken = anyBroken || vertex.normal == kBroken;
    }
    if (!anyBroken) return;
    const std::vector<glm::dvec3> sums = faceVectorSums(mesh);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        if (mesh.vertices[i].normal == kBroken)
            mesh.vertices[i].normal = unitOr(sums[i], {0, 0, 1});
}

void generateTangents(Mesh& mesh, std::uint32_t uvSet, const glm::mat3x2& uvTransform) {
    std::vector<UvFrame> frames(mesh.indices.size() / 3);
    for (std::size_t t = 0; t < frames.size(); ++t) {
        std::array<glm::dvec3, 3> p;
        std::array<glm::dvec2, 3> uv;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vertex& vertex = mesh.vertices[mesh.indices[3 * t + k]];
            p[k] = vertex.position;
            uv[k] =
                glm::dmat3x2(uvTransform) * glm::dvec3(uvSet == 0 ? vertex.uv0 : vertex.uv1, 1.0);
        }
        frames[t] = uvFrame(p, uv);
    }
    splitMirrored(mesh, frames);

    std::vector<UvFrame> sums(mesh.vertices.size());
    for (std::size_t i = 0; i < frames.size() * 3; ++i) {
        UvFrame& sum = sums[mesh.indices[i]];
        sum.alongU += frames[i / 3].alongU;
        sum.alongV += frames[i / 3].alongV;
        sum.handedness += frames[i / 3].handedness;
    }
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        Vertex& vertex = mesh.vertices[i];
        const glm::dvec3 n = vertex.normal, u = sums[i].alongU;
        const glm::dvec3 flat = u - n * glm::dot(n, u);
        // A remainder that is all cancellation is no direction.
        const bool usable = glm::length(flat) > 1e-6 * glm::length(u);
        const glm::vec3 tangent = usable ? unitOr(flat, anyPerpendicular(vertex.normal))
                                         : anyPerpendicular(vertex.normal);
        const double up = glm::dot(glm::cross(n, glm::dvec3(tangent)), -sums[i].alongV);
        const double side = usable && up != 0 ? up : sums[i].handedness;
        vertex.tangent = glm::vec4(tangent, side < 0 ? -1.0f : 1.0f);
    }
}

void repairTangents(Mesh& mesh) {
    for (Vertex& vertex : mesh.vertices)
        vertex.tangent =
            glm::vec4(unitOr(glm::dvec3(vertex.tangent), anyPerpendicular(vertex.normal)),
                      vertex.tangent.w < 0 ? -1.0f : 1.0f);
}

}  // namespace lodestar::scene

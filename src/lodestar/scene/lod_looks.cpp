// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/lod_looks.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>

namespace lodestar::scene {
namespace {

constexpr std::size_t kSamples = 8000;
// What a wrong normal counts: with 7, one that is off by 0.14 (8°) over a patch of a pixel is
// as bad as an edge that is off by one. Set with kPlace.
constexpr float kLight = 7.0f;
constexpr glm::vec3 kLuminance{0.2126f, 0.7152f, 0.0722f};

std::uint64_t keyOf(glm::vec3 p) {
    const glm::vec3 same = p + 0.0f;  // −0 as 0
    const auto bits = std::bit_cast<std::array<std::uint32_t, 3>>(same);
    std::uint64_t key = 0;
    for (const std::uint32_t b : bits) key = (key ^ b) * 0x9e3779b97f4a7c15ull;
    return key;
}

/// Weights of the point of a triangle that is nearest to `p` (Ericson 2005, 5.1.5).
glm::vec3 nearestWeights(glm::vec3 p, glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
    const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    const glm::vec3 bp = p - b;
    const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    const glm::vec3 cp = p - c;
    const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) {
        const float w = (d4 - d3) / (d4 - d3 + d5 - d6);
        return {0, 1 - w, w};
    }
    const float sum = va + vb + vc;
    return sum > 0 ? glm::vec3(va, vb, vc) / sum : glm::vec3(1, 0, 0);
}

}  // namespace

Nearest::Nearest(const Mesh& m, const Indices& to) : mesh(&m), points(to) {
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    build(0, points.size(), 0);
}

void Nearest::build(std::size_t begin, std::size_t end, int axis) {
    if (end - begin < 2) return;
    const std::size_t middle = (begin + end) / 2;
    using Difference = std::ptrdiff_t;
    std::nth_element(points.begin() + Difference(begin), points.begin() + Difference(middle),
                     points.begin() + Difference(end), [&](std::uint32_t a, std::uint32_t b) {
                         return mesh->vertices[a].position[axis] < mesh->vertices[b].position[axis];
                     });
    build(begin, middle, (axis + 1) % 3);
    build(middle + 1, end, (axis + 1) % 3);
}

void Nearest::search(glm::vec3 p, std::size_t begin, std::size_t end, int axis, Found& best) const {
    if (begin >= end) return;
    const std::size_t middle = (begin + end) / 2;
    const glm::vec3 q = mesh->vertices[points[middle]].position;
    const float distance2 = glm::dot(p - q, p - q);
    if (distance2 < best.distance2) best = {points[middle], distance2};
    const float side = p[axis] - q[axis];
    const int nextAxis = (axis + 1) % 3;
    const auto low = [&] { search(p, begin, middle, nextAxis, best); };
    const auto high = [&] { search(p, middle + 1, end, nextAxis, best); };
    side < 0 ? low() : high();
    if (side * side < best.distance2) side < 0 ? high() : low();
}

LooksError::LooksError(const Mesh& m, bool usesTextures) : mesh(&m), textured(usesTextures) {
    // Texture widths in a unit of length, over all triangles.
    double uv = 0, area = 0;
    for (std::size_t i = 0; i < m.indices.size(); i += 3) {
        const Vertex &a = m.vertices[m.indices[i]], &b = m.vertices[m.indices[i + 1]],
                     &c = m.vertices[m.indices[i + 2]];
        const glm::vec2 ab = b.uv0 - a.uv0, ac = c.uv0 - a.uv0;
        uv += std::abs(ab.x * ac.y - ab.y * ac.x);
        area += glm::length(glm::cross(b.position - a.position, c.position - a.position));
    }
    density = area > 0 ? float(std::sqrt(uv / area)) : 0;
}

LooksError::Found LooksError::of(const Indices& level, bool everyVertex) const {
    const Nearest nearest(*mesh, level);
    // Triangles at each place, of all the vertices there are at a seam.
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> at;
    for (std::uint32_t i = 0; i < level.size(); ++i)
        at[keyOf(mesh->vertices[level[i]].position)].push_back(i / 3);
    const std::size_t step =
        everyVertex ? 1 : std::max<std::size_t>(mesh->indices.size() / kSamples, 1);
    double sum = 0;
    float farthest = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < mesh->indices.size(); i += step, ++count) {
        const Vertex& v = mesh->vertices[mesh->indices[i]];
        const Nearest::Found found = nearest.find(v.position);
        const Difference off = differenceAt(v, at.at(keyOf(mesh->vertices[found.vertex].position)),
                                            level, std::sqrt(found.distance2));
        sum += double(off.looks) * off.looks;
        farthest = std::max(farthest, off.place);
    }
    if (count == 0) return {0, 0};
    return {float(std::sqrt(sum / double(count))), step == 1 ? farthest : INFINITY};
}

/// The least to any of the triangles about the vertex nearest to `v`, which is `apart` from it.
LooksError::Difference LooksError::differenceAt(const Vertex& v,
                                                const std::vector<std::uint32_t>& triangles,
                                                const Indices& level, float apart) const {
    // As much as it is seen: half a stop of a dark surface is fewer steps of the picture.
    const float seen = std::sqrt(std::max(glm::dot(glm::vec3(v.color), kLuminance), 0.0f));
    Difference best;
    for (const std::uint32_t t : triangles) {
        const Vertex &a = mesh->vertices[level[3 * t]], &b = mesh->vertices[level[3 * t + 1]],
                     &c = mesh->vertices[level[3 * t + 2]];
        const glm::vec3 w = nearestWeights(v.position, a.position, b.position, c.position);
        const glm::vec3 normal = a.normal * w.x + b.normal * w.y + c.normal * w.z;
        const float l = glm::length(normal);
        const float lit = l > 0 ? glm::length(normal / l - v.normal) : 2;
        const float painted = glm::length(a.color * w.x + b.color * w.y + c.color * w.z - v.color);
        float off = kLight * (seen * lit + 2 * painted) * apart;
        if (textured && density > 0) {
            const glm::vec2 uv = a.uv0 * w.x + b.uv0 * w.y + c.uv0 * w.z;
            off += glm::length(uv - v.uv0) / density;
        }
        best.looks = std::min(best.looks, off);
        best.place = std::min(
            best.place,
            glm::distance(v.position, a.position * w.x + b.position * w.y + c.position * w.z));
    }
    return best;
}

}  // namespace lodestar::scene

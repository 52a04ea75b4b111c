// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/meshlets.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace lodestar::scene {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// The same triangle with its smallest index first; winding is kept.
Triangle rotated(Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
}

/// A closed, bumpy torus of 2·around·along triangles.
Mesh bumpyTorus(std::uint32_t around, std::uint32_t along, float bump) {
    Mesh mesh;
    for (std::uint32_t i = 0; i < along; ++i)
        for (std::uint32_t j = 0; j < around; ++j) {
            const float a = 6.2831853f * float(i) / float(along);
            const float b = 6.2831853f * float(j) / float(around);
            const float r = 0.4f + bump * std::sin(7 * a) * std::cos(5 * b);
            mesh.vertices.push_back({});
            mesh.vertices.back().position = {(1 + r * std::cos(b)) * std::cos(a), r * std::sin(b),
                                             (1 + r * std::cos(b)) * std::sin(a)};
            const std::uint32_t i1 = (i + 1) % along, j1 = (j + 1) % around;
            const std::uint32_t p = i * around + j, q = i * around + j1, s = i1 * around + j,
                                t = i1 * around + j1;
            for (std::uint32_t index : {p, q, s, s, q, t}) mesh.indices.push_back(index);
        }
    return mesh;
}

/// Triangles with corners anywhere, many of them degenerate: two corners the same.
Mesh soup(std::uint32_t triangles, std::uint32_t seed) {
    std::mt19937 random(seed);
    Mesh mesh;
    const std::uint32_t vertices = 3 + triangles / 2;
    for (std::uint32_t i = 0; i < vertices; ++i) {
        mesh.vertices.push_back({});
        mesh.vertices.back().position = {random() % 97, random() % 89, random() % 83};
    }
    for (std::uint32_t i = 0; i < 3 * triangles; ++i)
        mesh.indices.push_back(i % 3 && random() % 4 == 0 ? mesh.indices.back()
                                                          : random() % vertices);
    return mesh;
}

std::map<Triangle, int> trianglesOf(const Mesh& mesh) {
    std::map<Triangle, int> count;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        ++count[rotated({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]})];
    return count;
}

std::vector<Triangle> trianglesOf(const MeshletSet& set, const Meshlet& meshlet) {
    std::vector<Triangle> triangles;
    for (std::uint32_t i = 0; i < meshlet.triangleCount; ++i) {
        const std::uint32_t packed = set.triangles.at(meshlet.triangleOffset + i);
        Triangle triangle{};
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t local = packed >> (8 * k) & 0xff;
            EXPECT_LT(local, meshlet.vertexCount);
            triangle[k] = set.vertices.at(meshlet.vertexOffset + local);
        }
        EXPECT_EQ(packed >> 24, 0u);
        triangles.push_back(triangle);
    }
    return triangles;
}

std::vector<Mesh> samples() {
    return {bumpyTorus(5, 7, 0), bumpyTorus(64, 128, 0.1f), soup(1, 1), soup(125, 2),
            soup(3000, 3)};
}

TEST(Meshlets, everyTriangleIsInExactlyOneMeshlet) {
    for (const Mesh& mesh : samples()) {
        const MeshletSet set = buildMeshlets(mesh);
        std::map<Triangle, int> count;
        for (const Meshlet& meshlet : set.meshlets) {
            EXPECT_LE(meshlet.vertexCount, kMeshletVertices);
            EXPECT_LE(meshlet.triangleCount, kMeshletTriangles);
            EXPECT_GT(meshlet.triangleCount, 0u);
            for (const Triangle& triangle : trianglesOf(set, meshlet)) ++count[rotated(triangle)];
        }
        EXPECT_EQ(count, trianglesOf(mesh));
        EXPECT_EQ(set.triangles.size(), mesh.indices.size() / 3);
    }
}

TEST(Meshlets, spheresHoldTheirVertices) {
    for (const Mesh& mesh : samples()) {
        const MeshletSet set = buildMeshlets(mesh);
        for (const Meshlet& meshlet : set.meshlets)
            for (std::uint32_t i = 0; i < meshlet.vertexCount; ++i) {
                const glm::dvec3 p = mesh.vertices[set.vertices[meshlet.vertexOffset + i]].position;
                EXPECT_LE(glm::distance(p, glm::dvec3(meshlet.centre)), double(meshlet.radius));
            }
    }
}

TEST(Meshlets, spheresAreNotMuchLargerThanTheirMeshlets) {
    const Mesh mesh = bumpyTorus(64, 128, 0.1f);
    const MeshletSet set = buildMeshlets(mesh);
    for (const Meshlet& meshlet : set.meshlets) {
        Bounds box;
        for (std::uint32_t i = 0; i < meshlet.vertexCount; ++i)
            box.add(mesh.vertices[set.vertices[meshlet.vertexOffset + i]].position);
        EXPECT_LE(meshlet.radius, 1.2f * box.radius());
    }
}

TEST(Meshlets, conesCullOnlyMeshletsThatFaceAway) {
    const Mesh mesh = bumpyTorus(64, 128, 0.1f);
    const MeshletSet set = buildMeshlets(mesh);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-4, 4);
    int culled = 0, facingAway = 0;
    for (int e = 0; e < 60; ++e) {
        const glm::vec3 eye(place(random), place(random), place(random));
        for (const Meshlet& meshlet : set.meshlets) {
            const glm::vec3 to = meshlet.centre - eye;
            const bool cull = glm::dot(to, meshlet.coneAxis) >=
                              meshlet.coneCutoff * glm::length(to) + meshlet.radius;
            bool away = true;
            for (const Triangle& t : trianglesOf(set, meshlet)) {
                const glm::dvec3 a = mesh.vertices[t[0]].position, b = mesh.vertices[t[1]].position,
                                 c = mesh.vertices[t[2]].position;
                away &= glm::dot(glm::cross(b - a, c - a), a - glm::dvec3(eye)) >= -1e-9;
            }
            EXPECT_TRUE(away || !cull);
            culled += cull;
            facingAway += away;
        }
    }
    EXPECT_GT(culled, facingAway / 3);  // the test is worth making
}

TEST(Meshlets, meshletOfDegenerateTrianglesIsKeptAndNeverCulled) {
    Mesh mesh = soup(1, 9);
    mesh.indices = {0, 0, 1, 2, 2, 2};
    const MeshletSet set = buildMeshlets(mesh);
    ASSERT_EQ(set.meshlets.size(), 1u);
    EXPECT_EQ(set.meshlets[0].triangleCount, 2u);
    EXPECT_EQ(set.meshlets[0].coneCutoff, 1);
    EXPECT_GT(set.meshlets[0].radius, 0);
}

TEST(Meshlets, theSameMeshGivesTheSameMeshlets) {
    const Mesh mesh = bumpyTorus(40, 60, 0.1f);
    const MeshletSet a = buildMeshlets(mesh), b = buildMeshlets(mesh);
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
    ASSERT_EQ(a.meshlets.size(), b.meshlets.size());
    EXPECT_EQ(
        std::memcmp(a.meshlets.data(), b.meshlets.data(), a.meshlets.size() * sizeof(Meshlet)), 0);
}

TEST(Meshlets, countIsNearTheLeastPossible) {
    // A closed regular mesh has half as many vertices as triangles; a patch of 64 vertices with its
    // border has at most 7·7·2 = 98 triangles.
    std::mt19937 random(11);
    for (int i = 0; i < 6; ++i) {
        const Mesh mesh = bumpyTorus(32 + random() % 64, 32 + random() % 64, 0.1f);
        const double least = std::ceil(double(mesh.indices.size() / 3) / 98.0);
        EXPECT_LE(double(buildMeshlets(mesh).meshlets.size()), 1.35 * least);
    }
}

TEST(Meshlets, emptyMeshHasNone) {
    EXPECT_TRUE(buildMeshlets({}).meshlets.empty());
}

TEST(Meshlets, badIndicesAreRefused) {
    Mesh mesh = soup(4, 1);
    mesh.indices[5] = static_cast<std::uint32_t>(mesh.vertices.size());
    EXPECT_THROW(buildMeshlets(mesh), std::invalid_argument);
    mesh.indices = {0, 1};
    EXPECT_THROW(buildMeshlets(mesh), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::scene

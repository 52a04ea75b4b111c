// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include <lodestar/scene/mesh_lods.hpp>

#include "small_scenes.hpp"
#include "temp_folder.hpp"

namespace lodestar::scene {
namespace {

namespace fs = std::filesystem;

Mesh ball(std::uint32_t across = 64) {
    Mesh mesh =
        small_scenes::parts::patch(small_scenes::parts::sphere(1), across, across / 2, {1, 1});
    for (const std::uint32_t i : mesh.indices) mesh.bounds.add(mesh.vertices[i].position);
    return mesh;
}

std::size_t trianglesOf(const MeshLod& lod) {
    return lod.meshlets.triangles.size();
}

/// The triangles of a level, as vertices of the mesh.
std::vector<std::array<std::uint32_t, 3>> trianglesIn(const MeshLod& lod) {
    std::vector<std::array<std::uint32_t, 3>> all;
    for (const Meshlet& m : lod.meshlets.meshlets)
        for (std::uint32_t i = 0; i < m.triangleCount; ++i) {
            const std::uint32_t t = lod.meshlets.triangles[m.triangleOffset + i];
            const std::uint32_t* v = &lod.meshlets.vertices[m.vertexOffset];
            all.push_back({v[t & 255], v[t >> 8 & 255], v[t >> 16]});
        }
    return all;
}

/// Edges that only one triangle has, by position.
using Place = std::array<float, 3>;
std::set<std::pair<Place, Place>> openEdges(const Mesh& mesh, const MeshLod& lod) {
    std::map<std::pair<Place, Place>, int> count;
    for (const auto& t : trianglesIn(lod))
        for (int i = 0; i < 3; ++i) {
            const auto place = [&](int k) {
                const glm::vec3 p = mesh.vertices[t[k % 3]].position;
                return Place{p.x, p.y, p.z};
            };
            ++count[std::minmax(place(i), place(i + 1))];
        }
    std::set<std::pair<Place, Place>> open;
    for (const auto& [edge, n] : count)
        if (n == 1) open.insert(edge);
    return open;
}

/// Every triangle with corners of its own, as flat-shaded models have them.
Mesh flatShaded(const Mesh& smooth) {
    Mesh flat = smooth;
    flat.vertices.clear();
    flat.indices.clear();
    for (std::size_t i = 0; i < smooth.indices.size(); i += 3) {
        Vertex corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = smooth.vertices[smooth.indices[i + k]];
        const glm::vec3 n = glm::normalize(glm::cross(corner[1].position - corner[0].position,
                                                      corner[2].position - corner[0].position));
        for (Vertex& v : corner) {
            v.normal = n;
            flat.indices.push_back(std::uint32_t(flat.vertices.size()));
            flat.vertices.push_back(v);
        }
    }
    return flat;
}

TEST(MeshLods, everyLevelHasFewerTrianglesAndNoSmallerError) {
    const MeshLods lods = buildMeshLods(ball(), false);
    ASSERT_GE(lods.levels.size(), 6u);
    EXPECT_EQ(lods.levels[0].error, 0);
    for (std::size_t i = 1; i < lods.levels.size(); ++i) {
        const MeshLod &finer = lods.levels[i - 1], &lod = lods.levels[i];
        EXPECT_LE(double(trianglesOf(lod)), 0.8 * double(trianglesOf(finer)));
        EXPECT_GE(lod.error, finer.error);
        EXPECT_LE(lod.meshlets.meshlets.size(), finer.meshlets.meshlets.size());
    }
    EXPECT_LT(trianglesOf(lods.levels.back()), 200u);
}

TEST(MeshLods, verticesOfASimplifiedSphereLieOnItAndItsFacesWithinTheError) {
    const Mesh mesh = ball();
    for (const MeshLod& lod : buildMeshLods(mesh, false).levels) {
        if (lod.method == LodMethod::sloppy) continue;
        for (const auto& t : trianglesIn(lod)) {
            const glm::vec3 centre = (mesh.vertices[t[0]].position + mesh.vertices[t[1]].position +
                                      mesh.vertices[t[2]].position) /
                                     3.0f;
            // The mesh itself is off the sphere by what its own facets are.
            EXPECT_GE(glm::length(centre), 1 - 2 * lod.offPlace - 0.01f) << nameOf(lod.method);
        }
    }
}

TEST(MeshLods, bordersStayWhereTheyAreAndNoneOpen) {
    // Rolling ground with an edge, on which a neighbouring mesh could lie.
    Mesh ground = small_scenes::parts::patch(
        [](double u, double v) {
            return glm::dvec3(u * 8, 0.4 * std::sin(7 * u) * std::cos(5 * v), v * 8);
        },
        40, 40, {1, 1});
    const MeshLods lods = buildMeshLods(ground, true);
    ASSERT_GE(lods.levels.size(), 3u);
    const auto border = openEdges(ground, lods.levels[0]);
    EXPECT_EQ(border.size(), 160u);
    for (const MeshLod& lod : lods.levels)
        if (lod.method == LodMethod::simplified) {
            EXPECT_EQ(openEdges(ground, lod), border);
        }
}

TEST(MeshLods, anAttributeSeamDoesNotCrack) {
    // A tube that closes to the bit, with a seam of texture coordinates along it and open ends.
    constexpr int kAcross = 32, kDown = 40;
    Mesh tube = small_scenes::parts::patch(
        [](double u, double v) {
            const double turns = u - std::floor(u), a = 2 * M_PI * turns;
            return glm::dvec3((1 + 0.1 * std::sin(9 * v)) * std::sin(a), 4 * (0.5 - v),
                              (1 + 0.1 * std::sin(9 * v)) * std::cos(a));
        },
        kAcross, kDown, {1, 1});
    const MeshLods lods = buildMeshLods(tube, true);
    ASSERT_GE(lods.levels.size(), 3u);
    for (const MeshLod& lod : lods.levels)
        if (lod.method == LodMethod::simplified) {
            EXPECT_EQ(openEdges(tube, lod).size(), 2u * kAcross) << trianglesOf(lod);
        }
}

TEST(MeshLods, flatShadedMeshesAreSimplifiedOverWeldedPositions) {
    const Mesh flat = flatShaded(ball(48));
    const MeshLods welded = buildMeshLods(flat, false);
    ASSERT_GE(welded.levels.size(), 5u);
    EXPECT_EQ(welded.levels[1].method, LodMethod::welded);
    const MeshLods split = buildMeshLods(flat, true);
    EXPECT_EQ(split.levels[1].method, LodMethod::sloppy);
    EXPECT_LT(welded.levels[1].offPlace, split.levels[1].offPlace / 4);
}

TEST(MeshLods, manySmallPartsAreClusteredWithTheErrorOfWhatVanishes) {
    // Leaves: triangles that touch nothing.
    small_scenes::Random random(5);
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 at = random.vec3(-1, 1);
        for (int k = 0; k < 3; ++k) corners.push_back(at + random.vec3(-0.02f, 0.02f));
    }
    const Mesh leaves = small_scenes::triangles(corners);
    const MeshLods lods = buildMeshLods(leaves, true);
    ASSERT_GE(lods.levels.size(), 2u);
    for (std::size_t i = 1; i < lods.levels.size(); ++i) {
        const MeshLod& lod = lods.levels[i];
        ASSERT_TRUE(lod.method == LodMethod::opened || lod.method == LodMethod::sloppy);
        std::set<std::uint32_t> left;
        for (const auto& t : trianglesIn(lod)) left.insert(t.begin(), t.end());
        float farthest = 0;
        for (const Vertex& v : leaves.vertices) {
            float nearest = 1e9f;
            for (const std::uint32_t k : left)
                nearest = std::min(nearest, glm::distance(v.position, leaves.vertices[k].position));
            farthest = std::max(farthest, nearest);
        }
        if (i == 1) {
            EXPECT_NEAR(lod.offPlace, farthest, 1e-5);
        }
        EXPECT_GE(lod.offPlace, farthest - 1e-5f);
    }
}

TEST(MeshLods, meshesThatCannotBeSimplifiedStayWhole) {
    Mesh none;
    EXPECT_EQ(buildMeshLods(none, false).levels.size(), 1u);
    const Mesh one = small_scenes::triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_EQ(buildMeshLods(one, false).levels.size(), 1u);
    Mesh nan = ball(16);
    nan.vertices[7].position.y = NAN;
    EXPECT_EQ(buildMeshLods(nan, false).levels.size(), 1u);
    Mesh point = ball(16);  // no area anywhere
    for (Vertex& v : point.vertices) v.position = {1, 2, 3};
    for (const MeshLod& lod : buildMeshLods(point, false).levels) EXPECT_GE(lod.error, 0);
    Mesh soup = ball(16);  // no manifold: every triangle with any other
    small_scenes::Random random(9);
    for (std::uint32_t& i : soup.indices)
        i = std::uint32_t(random(0, float(soup.vertices.size()) - 1));
    for (const MeshLod& lod : buildMeshLods(soup, false).levels)
        EXPECT_TRUE(std::isfinite(lod.error));
}

Scene sceneOf(int meshes) {
    small_scenes::SceneBuilder builder("several");
    const std::uint32_t material = builder.add(Material{});
    for (int i = 0; i < meshes; ++i)
        builder.place(builder.add("ball", ball(std::uint32_t(40 + 20 * i)), material));
    return std::move(builder).finish();
}

bool same(const MeshLods& a, const MeshLods& b) {
    return encodeLods(a) == encodeLods(b);
}

TEST(MeshLods, aSceneIsBuiltInParallelToWhatItsMeshesGive) {
    const Scene scene = sceneOf(5);
    int last = 0;
    const auto all = buildSceneLods(scene, {}, [&](int done, int of) {
        EXPECT_GT(done, last);
        EXPECT_EQ(of, 5);
        last = done;
    });
    EXPECT_EQ(last, 5);
    for (std::size_t i = 0; i < all.size(); ++i)
        EXPECT_TRUE(same(all[i], buildMeshLods(scene.meshes[i], false))) << i;
    for (const MeshLods& lods : buildSceneLods(scene, {.simplify = false}))
        EXPECT_EQ(lods.levels.size(), 1u);
}

TEST(MeshLods, aChainIsFoundInTheCacheAndACorruptOneIsBuiltAgain) {
    const TempFolder folder;
    const Scene scene = sceneOf(4);  // the last two are large enough to be kept
    const LodSettings settings{.cache = folder / ""};
    const auto built = buildSceneLods(scene, settings);
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder / "lods")) files.push_back(entry.path());
    ASSERT_FALSE(files.empty());
    for (const fs::path& file : files) EXPECT_EQ(file.extension(), ".lods");

    const auto stamp = fs::last_write_time(files[0]) - std::chrono::hours(1);
    fs::last_write_time(files[0], stamp);
    const auto found = buildSceneLods(scene, settings);
    for (std::size_t i = 0; i < built.size(); ++i) EXPECT_TRUE(same(found[i], built[i]));
    EXPECT_EQ(fs::last_write_time(files[0]), stamp) << "was written again";

    std::ofstream(files[0], std::ios::binary) << "not a chain";
    const auto again = buildSceneLods(scene, settings);
    for (std::size_t i = 0; i < built.size(); ++i) EXPECT_TRUE(same(again[i], built[i]));
    EXPECT_GT(fs::file_size(files[0]), 1000u) << "the corrupt file was not replaced";
}

TEST(MeshLods, theCacheKnowsAnotherMeshByItsName) {
    const Mesh mesh = ball(16);
    Mesh moved = mesh, turned = mesh;
    moved.vertices[3].position.x += 1e-6f;
    std::swap(turned.indices[0], turned.indices[1]);
    EXPECT_NE(lodCacheName(mesh, false), lodCacheName(moved, false));
    EXPECT_NE(lodCacheName(mesh, false), lodCacheName(turned, false));
    EXPECT_NE(lodCacheName(mesh, false), lodCacheName(mesh, true));
    EXPECT_EQ(lodCacheName(mesh, false), lodCacheName(ball(16), false));
}

/// Every copy is exactly as long as it says, so that ASan sees a read past its end.
std::optional<MeshLods> decodeCopy(const std::vector<std::byte>& bytes, const Mesh& mesh) {
    const std::unique_ptr<std::byte[]> copy(new std::byte[bytes.size()]);
    std::copy(bytes.begin(), bytes.end(), copy.get());
    return decodeLods({copy.get(), bytes.size()}, mesh);
}

TEST(MeshLods, noTruncationOrBitFlipOfAChainIsTaken) {
    const Mesh mesh = ball(12);
    const auto bytes = encodeLods(buildMeshLods(mesh, false));
    ASSERT_TRUE(decodeCopy(bytes, mesh));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        ASSERT_FALSE(decodeCopy({bytes.begin(), bytes.begin() + std::ptrdiff_t(size)}, mesh))
            << size;
    for (std::size_t i = 0; i < bytes.size(); ++i)
        for (int bit = 0; bit < 8; ++bit) {
            auto flipped = bytes;
            flipped[i] ^= std::byte(1 << bit);
            ASSERT_FALSE(decodeCopy(flipped, mesh)) << i;
        }
    auto longer = bytes;
    longer.push_back({});
    EXPECT_FALSE(decodeCopy(longer, mesh));
}

TEST(MeshLods, aChainWithAGoodChecksumThatDoesNotFitTheMeshIsRefused) {
    const Mesh mesh = ball(12);
    const MeshLods good = buildMeshLods(mesh, false);
    const auto refused = [&](auto change) {
        MeshLods bad = good;
        change(bad);
        return !decodeCopy(encodeLods(bad), mesh);
    };
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels[0].meshlets.vertices[0] = 1u << 30; }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels[0].meshlets.triangles[0] = 0xffffff; }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels[0].meshlets.meshlets[0].vertexCount = 65; }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels[0].meshlets.meshlets[0].vertexOffset = ~0u; }));
    EXPECT_TRUE(refused([](MeshLods& l) { ++l.levels[0].meshlets.meshlets[0].triangleOffset; }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels[1].error = NAN; }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels[1].error = -1; }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels[1].method = LodMethod(9); }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels.erase(l.levels.begin()); }));
    EXPECT_TRUE(refused([](MeshLods& l) { l.levels.clear(); }));
    EXPECT_FALSE(refused([](MeshLods&) {}));
    Mesh smaller = mesh;
    smaller.vertices.resize(mesh.vertices.size() / 2);
    EXPECT_FALSE(decodeCopy(encodeLods(good), smaller));
}

}  // namespace
}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/procedural.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include <lodestar/scene/camera.hpp>

namespace lodestar::scene {
namespace {

/// Each scene is built once for all tests.
const Scene& built(const std::string& spec) {
    static std::map<std::string, Scene> known;
    const auto [entry, added] = known.try_emplace(spec);
    if (added) {
        Result<Scene> scene = buildBuiltin(spec);
        EXPECT_TRUE(scene) << scene.error().message;
        if (scene) entry->second = std::move(*scene);
    }
    return entry->second;
}

std::string refusal(const std::string& spec) {
    const Result<Scene> scene = buildBuiltin(spec);
    EXPECT_FALSE(scene) << spec;
    return scene ? "" : scene.error().message;
}

/// The scenes have no animation and no hierarchy: a node's own transform is its place in the world.
std::vector<glm::mat4> nodeMatrices(const Scene& scene) {
    std::vector<glm::mat4> result;
    for (const Node& node : scene.nodes) {
        EXPECT_EQ(node.parent, kNone);
        glm::mat4 world(glm::mat3_cast(node.rotation) * glm::mat3(node.scale.x));
        world[3] = glm::vec4(node.translation, 1);
        result.push_back(world);
    }
    return result;
}

const std::vector<std::string> kSpecs = {"columns", "spheres", "grid:2", "grid:12345",
                                         "grid:150000"};

TEST(Procedural, everyIndexIsInRange) {
    for (const std::string& spec : kSpecs) {
        const Scene& scene = built(spec);
        EXPECT_EQ(scene.name, "builtin:" + spec);
        for (const Mesh& mesh : scene.meshes) {
            EXPECT_LT(mesh.material, scene.materials.size());
            ASSERT_EQ(mesh.indices.size() % 3, 0u);
            ASSERT_FALSE(mesh.indices.empty());
            ASSERT_LT(*std::max_element(mesh.indices.begin(), mesh.indices.end()),
                      mesh.vertices.size());
        }
        for (const Instance& instance : scene.instances) {
            ASSERT_LT(instance.mesh, scene.meshes.size());
            ASSERT_LT(instance.node, scene.nodes.size());
        }
        for (const Texture& texture : scene.textures) ASSERT_LT(texture.image, scene.images.size());
        for (const Material& material : scene.materials)
            for (const TextureUse& use : {material.baseColorTexture, material.normalTexture,
                                          material.metallicRoughnessTexture})
                ASSERT_TRUE(use.texture == kNone || use.texture < scene.textures.size());
    }
}

TEST(Procedural, manyInstancesShareANodeAndTheirNumberIsExact) {
    for (const auto& [spec, more] :
         {std::pair{"mountains:300", 64}, std::pair{"instances:401", 0}}) {
        const Scene& scene = built(spec);
        const std::string name = spec;
        EXPECT_EQ(scene.instances.size(), std::stoul(name.substr(name.find(':') + 1)) + more);
        EXPECT_LT(scene.nodes.size(), 10u);
        for (const Instance& instance : scene.instances) {
            ASSERT_LT(instance.mesh, scene.meshes.size());
            ASSERT_EQ(instance.node, 0u);
        }
        for (const Mesh& mesh : scene.meshes)
            for (const Vertex& v : mesh.vertices) {
                ASSERT_NEAR(glm::length(v.normal), 1, 1e-3) << mesh.name;
                ASSERT_NEAR(glm::length(glm::vec3(v.tangent)), 1, 1e-3) << mesh.name;
            }
        for (const SceneCamera& camera : scene.cameras) EXPECT_LT(camera.node, scene.nodes.size());
    }
}

TEST(Procedural, normalsAndTangentsAreOrthonormalAndFaceTheWinding) {
    for (const std::string& spec : kSpecs)
        for (const Mesh& mesh : built(spec).meshes) {
            SCOPED_TRACE(spec + " " + mesh.name);
            std::size_t bad = 0;
            for (const Vertex& v : mesh.vertices) {
                const glm::vec3 tangent(v.tangent);
                const bool good = std::abs(glm::length(v.normal) - 1) < 1e-4f &&
                                  std::abs(glm::length(tangent) - 1) < 1e-4f &&
                                  std::abs(glm::dot(v.normal, tangent)) < 1e-3f && v.tangent.w == 1;
                bad += !good;
            }
            EXPECT_EQ(bad, 0u);
            std::size_t reversed = 0;
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                const Vertex &a = mesh.vertices[mesh.indices[i]],
                             &b = mesh.vertices[mesh.indices[i + 1]],
                             &c = mesh.vertices[mesh.indices[i + 2]];
                const glm::vec3 face = glm::cross(b.position - a.position, c.position - a.position);
                reversed += !(glm::dot(face, a.normal + b.normal + c.normal) > 0);
            }
            EXPECT_EQ(reversed, 0u);
        }
}

TEST(Procedural, textureCoordinatesRunAlongTheTangent) {
    for (const std::string& spec : kSpecs)
        for (const Mesh& mesh : built(spec).meshes) {
            SCOPED_TRACE(spec + " " + mesh.name);
            std::size_t right = 0;
            for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
                const Vertex &a = mesh.vertices[mesh.indices[i]],
                             &b = mesh.vertices[mesh.indices[i + 1]],
                             &c = mesh.vertices[mesh.indices[i + 2]];
                const glm::vec2 ab = b.uv0 - a.uv0, ac = c.uv0 - a.uv0;
                // Positive area in a space with v up means an image that is not mirrored.
                const float area = -(ab.x * ac.y - ab.y * ac.x);
                const glm::vec3 alongU =
                    (b.position - a.position) * ac.y - (c.position - a.position) * ab.y;
                right += area > 0 && glm::dot(-alongU, glm::vec3(a.tangent)) > 0;
            }
            EXPECT_GE(right, mesh.indices.size() / 3 * 98 / 100);
        }
}

TEST(Procedural, boundsAreThoseOfTheVerticesInUse) {
    for (const std::string& spec : kSpecs)
        for (const Mesh& mesh : built(spec).meshes) {
            Bounds bounds;
            for (std::uint32_t index : mesh.indices) bounds.add(mesh.vertices[index].position);
            EXPECT_EQ(mesh.bounds.lower, bounds.lower);
            EXPECT_EQ(mesh.bounds.upper, bounds.upper);
        }
}

TEST(Procedural, theSameSpecGivesTheSameScene) {
    for (const std::string& spec : kSpecs) {
        const Scene& a = built(spec);
        const Scene b = *buildBuiltin(spec);
        ASSERT_EQ(a.meshes.size(), b.meshes.size());
        for (std::size_t i = 0; i < a.meshes.size(); ++i) {
            EXPECT_EQ(a.meshes[i].indices, b.meshes[i].indices);
            ASSERT_EQ(a.meshes[i].vertices.size(), b.meshes[i].vertices.size());
            EXPECT_EQ(std::memcmp(a.meshes[i].vertices.data(), b.meshes[i].vertices.data(),
                                  a.meshes[i].vertices.size() * sizeof(Vertex)),
                      0);
        }
        for (std::size_t i = 0; i < a.images.size(); ++i)
            EXPECT_EQ(a.images[i].rgba, b.images[i].rgba);
    }
}

TEST(Procedural, columnsIsAHallWorthTesting) {
    const Scene& scene = built("columns");
    const TriangleCounts counts = countTriangles(scene);
    EXPECT_GT(counts.drawn, 50'000u);
    EXPECT_LT(counts.drawn, 250'000u);
    const Bounds bounds = worldBounds(scene, nodeMatrices(scene));
    EXPECT_GT(bounds.upper.y, 8);
    EXPECT_LT(bounds.upper.y, 20);
    bool metal = false, mask = false, normalMapped = false, emits = false;
    for (const Material& material : scene.materials) {
        metal |= material.metallic == 1 && material.baseColorTexture.texture == kNone;
        mask |= material.alphaMode == AlphaMode::mask;
        normalMapped |= material.normalTexture.texture != kNone;
        emits |= material.emissive.x > 0;
    }
    EXPECT_TRUE(metal && mask && normalMapped && emits);
}

TEST(Procedural, camerasStandInsideAndSeeTheScene) {
    for (const char* spec : {"columns", "spheres", "grid:150000"}) {
        const Scene& scene = built(spec);
        const std::vector<glm::mat4> world = nodeMatrices(scene);
        ASSERT_FALSE(scene.cameras.empty());
        for (const SceneCamera& source : scene.cameras) {
            const Camera camera = fromSceneCamera(source, world.at(source.node), 10);
            EXPECT_GT(camera.eye.y, 0);
            const glm::mat4 clip = camera.clipFromView(1.5f) * camera.viewFromWorld();
            std::size_t seen = 0;
            for (const Instance& instance : scene.instances) {
                const glm::vec3 centre = scene.meshes[instance.mesh].bounds.centre();
                const glm::vec4 p = clip * world[instance.node] * glm::vec4(centre, 1);
                seen += p.w > 0 && std::abs(p.x) < p.w && std::abs(p.y) < p.w;
            }
            EXPECT_GT(seen, scene.instances.size() / 5) << spec << " " << source.name;
        }
    }
}

/// Distance along the ray to the nearest triangle, negated where that one is seen from behind.
float nearestHit(const Scene& scene, glm::vec3 origin, glm::vec3 direction) {
    float nearest = 1e30f;
    const std::vector<glm::mat4> nodes = nodeMatrices(scene);
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        if (scene.materials[mesh.material].doubleSided) continue;
        const glm::mat4 toObject = glm::inverse(nodes[instance.node]);
        const glm::vec3 o = toObject * glm::vec4(origin, 1), d = toObject * glm::vec4(direction, 0);
        const glm::vec3 middle = mesh.bounds.centre();
        if (glm::length(glm::cross(middle - o, glm::normalize(d))) > mesh.bounds.radius()) continue;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const glm::vec3 a = mesh.vertices[mesh.indices[i]].position,
                            ab = mesh.vertices[mesh.indices[i + 1]].position - a,
                            ac = mesh.vertices[mesh.indices[i + 2]].position - a;
            const glm::vec3 p = glm::cross(d, ac), q = glm::cross(o - a, ab);
            const float det = glm::dot(ab, p);
            const float u = glm::dot(o - a, p) / det, v = glm::dot(d, q) / det;
            const float t = glm::dot(ac, q) / det;
            if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < std::abs(nearest))
                nearest = det > 0 ? t : -t;
        }
    }
    return nearest;
}

TEST(Procedural, theHallIsSeenFromTheFrontOfItsSurfaces) {
    const Scene& scene = built("columns");
    const std::vector<glm::mat4> nodes = nodeMatrices(scene);
    const Camera camera = fromSceneCamera(scene.cameras[0], nodes[scene.cameras[0].node], 10);
    const glm::mat3 worldFromView(glm::inverse(camera.viewFromWorld()));
    int hits = 0, behind = 0;
    for (int y = -6; y <= 6; ++y)
        for (int x = -8; x <= 8; ++x) {
            const float hit = nearestHit(
                scene, camera.eye, worldFromView * glm::vec3(0.1f * x + 0.01f, 0.08f * y, -1));
            hits += std::abs(hit) < 100;
            behind += hit < 0;
        }
    EXPECT_GT(hits, 180);
    EXPECT_EQ(behind, 0);
}

TEST(Procedural, closedPartsEncloseAPositiveVolume) {
    for (const Mesh& mesh : built("columns").meshes) {
        const bool open = mesh.name == "floor" || mesh.name == "turf" || mesh.name == "vault" ||
                          mesh.name == "apse" || mesh.name == "banner" || mesh.name == "lattice";
        if (open) continue;
        double volume = 0;  // rods lack their caps: measure from the middle of the part
        const glm::dvec3 middle = mesh.bounds.centre();
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            const glm::dvec3 a = mesh.vertices[mesh.indices[i]].position,
                             b = mesh.vertices[mesh.indices[i + 1]].position,
                             c = mesh.vertices[mesh.indices[i + 2]].position;
            volume += glm::dot(a - middle, glm::cross(b - middle, c - middle)) / 6;
        }
        EXPECT_GT(volume, 0) << mesh.name;
    }
}

TEST(Procedural, spheresSweepRoughnessAndMetallic) {
    const Scene& scene = built("spheres");
    std::set<float> roughness, metallic;
    for (const Material& material : scene.materials)
        if (material.baseColorTexture.texture == kNone) {
            roughness.insert(material.roughness);
            metallic.insert(material.metallic);
        }
    EXPECT_EQ(roughness.size(), 9u);
    EXPECT_EQ(metallic.size(), 5u);
    EXPECT_EQ(*roughness.begin(), 0);
    EXPECT_EQ(*metallic.rbegin(), 1);
}

TEST(Procedural, gridHasTheTrianglesAskedFor) {
    for (const std::uint64_t n : {2ull, 3ull, 7ull, 1000ull, 54321ull, 130050ull}) {
        const TriangleCounts counts = countTriangles(built("grid:" + std::to_string(n)));
        EXPECT_EQ(counts.drawn, n);
    }
    for (const std::uint64_t n : {130051ull, 500'000ull, 5'000'001ull, 100'000'000ull}) {
        const Scene& scene = built("grid:" + std::to_string(n));
        const double drawn = double(countTriangles(scene).drawn);
        EXPECT_NEAR(drawn / double(n), 1, 0.005) << n;
        for (const Mesh& mesh : scene.meshes) EXPECT_LE(mesh.vertices.size(), 65536u);
        EXPECT_LE(scene.meshes.size(), 16u);
    }
}

TEST(Procedural, gridTilesJoinWithoutSeams) {
    const Scene& scene = built("grid:2500000");  // more tiles than are stored
    ASSERT_GT(scene.instances.size(), scene.meshes.size());
    // Every border point of a tile lies on another tile at the same place with the same normal, but
    // for those of the field's own border.
    std::map<std::array<long, 3>, int> points;
    const Bounds field = worldBounds(scene, nodeMatrices(scene));
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (const Vertex& vertex : mesh.vertices) {
            const glm::vec3 p = vertex.position;
            const bool border = p.x == mesh.bounds.lower.x || p.x == mesh.bounds.upper.x ||
                                p.z == mesh.bounds.lower.z || p.z == mesh.bounds.upper.z;
            if (!border) continue;
            const glm::vec3 w = p + scene.nodes[instance.node].translation;
            if (w.x < field.lower.x + 0.05f || w.x > field.upper.x - 0.05f ||
                w.z < field.lower.z + 0.05f || w.z > field.upper.z - 0.05f)
                continue;
            ++points[{std::lround(w.x * 20), std::lround(w.y * 200), std::lround(w.z * 20)}];
        }
    }
    std::size_t lonely = 0;
    for (const auto& [point, count] : points) lonely += count < 2;
    EXPECT_LE(lonely, points.size() / 100);  // heights that fall between two rounding cells
}

TEST(Procedural, badSpecsAreRefusedInOneLineThatSaysWhatThereIs) {
    for (const char* spec : {"", "cube", "column", "columns ", "grid", "Grid:5"}) {
        const std::string message = refusal(spec);
        EXPECT_NE(message.find("builtin:columns, builtin:spheres, builtin:grid:N"), message.npos)
            << message;
        EXPECT_EQ(message.find('\n'), message.npos);
    }
    for (const char* spec :
         {"grid:", "grid:-4", "grid:1e6", "grid:ten", "grid:100 ", "grid:+5", "grid:1.5"})
        EXPECT_NE(refusal(spec).find("not a whole number"), std::string::npos) << spec;
    for (const char* spec : {"grid:0", "grid:1", "grid:100000001", "grid:99999999999999999999999"})
        EXPECT_NE(refusal(spec).find("from 2 to 100000000"), std::string::npos) << spec;
}

TEST(Procedural, everyListedSceneCanBeBuilt) {
    ASSERT_GE(builtins().size(), 3u);
    for (const Builtin& builtin : builtins()) {
        std::string spec = builtin.usage;
        if (const auto n = spec.find(":N"); n != spec.npos) spec.replace(n, 2, ":100");
        EXPECT_FALSE(built(spec).instances.empty());
        EXPECT_FALSE(builtin.description.empty());
    }
}

}  // namespace
}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <stb_perlin.h>
#include <glm/gtc/matrix_transform.hpp>

#include <lodestar/scene/procedural_parts.hpp>
#include <lodestar/scene/procedural_scenes.hpp>
#include <lodestar/scene/procedural_textures.hpp>

namespace lodestar::scene::procedural {
namespace {

using std::numbers::pi;

constexpr double kSide = 1024;                   // metres
constexpr std::uint32_t kTiles = 8;              // a side
constexpr std::uint32_t kQuads = 64;             // a side of a tile
constexpr double kTreeLine = 150, kValley = 12;  // metres

/// Noise that is the same on every machine: splitmix64.
class Random {
public:
    explicit Random(std::uint64_t seed) : state(seed) {}
    double operator()() {
        std::uint64_t z = state += 0x9e3779b97f4a7c15ull;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ z >> 27) * 0x94d049bb133111ebull;
        return double((z ^ z >> 31) >> 11) * 0x1p-53;
    }
    double operator()(double low, double high) { return low + (high - low) * (*this)(); }

private:
    std::uint64_t state;
};

double noise(double x, double y, int seed) {
    return stb_perlin_noise3_seed(float(x), float(y), 0.37f, 0, 0, 0, seed);
}

/// Ridges that rise away from a winding valley along z.
double height(double x, double z) {
    const double bend = 60 * std::sin(z * 0.008) + 25 * std::sin(z * 0.021 + 1);
    const double away = std::abs(x - bend);
    const double rise = std::clamp((away - 40) / 300, 0.0, 1.0);
    const double lift = rise * rise * (3 - 2 * rise);
    double ridges = 0, amplitude = 1, frequency = 1.0 / 260;
    for (int octave = 0; octave < 5; ++octave) {
        const double n = 1 - std::abs(noise(x * frequency, z * frequency, octave));
        ridges += amplitude * n * n;
        amplitude *= 0.45;
        frequency *= 2.1;
    }
    const double ground = 4 * noise(x / 40, z / 40, 11) + 0.8 * noise(x / 9, z / 9, 12);
    return ground + lift * (ridges * 150 - 20);
}

glm::dvec3 normalAt(double x, double z) {
    constexpr double kStep = 0.5;
    return glm::normalize(glm::dvec3(height(x - kStep, z) - height(x + kStep, z), 2 * kStep,
                                     height(x, z - kStep) - height(x, z + kStep)));
}

glm::vec3 groundColor(double y, double up) {
    const auto smooth = [](double low, double high, double v) {
        const double t = std::clamp((v - low) / (high - low), 0.0, 1.0);
        return float(t * t * (3 - 2 * t));
    };
    const glm::vec3 grass(0.10f, 0.17f, 0.05f), rock(0.23f, 0.21f, 0.19f), snow(0.85f, 0.87f, 0.9f);
    const glm::vec3 ground = glm::mix(rock, grass, smooth(0.68, 0.82, up));
    return glm::mix(ground, snow, smooth(150, 185, y) * smooth(0.55, 0.75, up));
}

Mesh terrainTile(std::uint32_t column, std::uint32_t row) {
    constexpr double kTile = kSide / kTiles;
    const double x0 = -kSide / 2 + column * kTile, z0 = -kSide / 2 + row * kTile;
    // Seen from above, u to the right and v towards the viewer.
    const Surface surface = [=](double u, double v) {
        const double x = x0 + u * kTile, z = z0 + v * kTile;
        return glm::dvec3(x, height(x, z), z);
    };
    Mesh mesh = patch(surface, kQuads, kQuads, {16, 16});
    for (Vertex& v : mesh.vertices) {
        // The field's own, so that neighbouring tiles agree to the bit.
        const glm::dvec3 n = normalAt(v.position.x, v.position.z);
        v.normal = n;
        v.tangent = glm::vec4(glm::vec3(glm::normalize(glm::dvec3(n.y, -n.x, 0))), 1);
        v.color = glm::vec4(groundColor(v.position.y, n.y), 1);
    }
    // Tufts and stones, which the mesh is too coarse for.
    mesh.displacement = Displacement{.amplitude = 0.28f, .wavelength = 3.1f, .octaves = 3};
    return mesh;
}

void paint(Mesh& mesh, glm::vec3 color) {
    for (Vertex& v : mesh.vertices) v.color = glm::vec4(color, 1);
}

/// A trunk and tiers of drooping branches.
Mesh conifer(int seed) {
    Random random(std::uint64_t(seed) * 77 + 5);
    const double tall = random(7, 11), wide = random(1.7, 2.4);
    constexpr int kTiers = 6;
    Mesh tree = patch(rod({0, tall * 0.6, 0}, {0, -0.6, 0}, 0.18), 12, 6, {1, 1});
    paint(tree, {0.09f, 0.055f, 0.03f});
    for (int tier = 0; tier < kTiers; ++tier) {
        const double low = tall * (0.12 + 0.14 * tier), high = low + tall * 0.3;
        const double radius = wide * (1 - 0.8 * double(tier) / kTiers);
        const double phase = random(0, 2 * pi), boughs = std::floor(random(6, 10));
        const Surface skirt = [=](double u, double v) {
            const double a = 2 * pi * (u - std::floor(u));  // closed to the bit at u = 1
            const double bough = 1 + 0.22 * v * std::cos(boughs * a + phase);
            const double r = radius * v * bough;
            const double y = high + (low - high) * v - 0.25 * v * v * std::cos(boughs * a + phase);
            return glm::dvec3(r * std::sin(a), y, r * std::cos(a));
        };
        const Surface below = [=](double u, double v) {
            return glm::mix(skirt(u, 1), glm::dvec3(0, low + 0.3 * (high - low), 0), v);
        };
        Mesh part = patch(skirt, 36, 6, {1, 1});
        append(part, patch(below, 36, 1, {1, 1}));
        paint(part, glm::vec3(0.03f, 0.085f, 0.03f) * float(random(0.8, 1.25)));
        append(tree, part);
    }
    return tree;
}

/// A lump: a sphere pushed about.
Mesh rock(int seed) {
    const Surface lump = [seed](double u, double v) {
        const double a = 2 * pi * (u - std::floor(u)), s = std::sin(pi * v);
        const glm::dvec3 d(s * std::sin(a), std::cos(pi * v), s * std::cos(a));
        const auto at = [&](double f, int octave) {
            return double(stb_perlin_noise3_seed(float(d.x * f + 9), float(d.y * f + 9),
                                                 float(d.z * f + 9), 0, 0, 0, 20 * seed + octave));
        };
        const double r = 1 + 0.45 * at(1.3, 1) + 0.2 * at(3.1, 2) + 0.06 * at(8, 3);
        return d * r * glm::dvec3(1.2, 0.75, 1);
    };
    Mesh mesh = patch(lump, 40, 20, {2, 1});
    paint(mesh, {0.24f, 0.225f, 0.21f});
    return mesh;
}

/// Instances hang from one node: a million nodes would only take memory.
void place(Scene& scene, std::uint32_t mesh, const glm::mat4& worldFromObject) {
    scene.instances.push_back({mesh, 0, worldFromObject});
}

glm::mat4 standing(glm::dvec3 at, double turn, double scale) {
    const glm::mat4 there = glm::translate(glm::mat4(1), glm::vec3(at));
    return glm::scale(glm::rotate(there, float(turn), glm::vec3(0, 1, 0)), glm::vec3(float(scale)));
}

}  // namespace

Scene buildMountains(std::uint64_t objects) {
    SceneBuilder builder(objects == kMountainObjects
                             ? "builtin:mountains"
                             : fmt::format("builtin:mountains:{}", objects));
    builder.addCamera("valley", {-20, float(height(-20, 420)) + 14, 420}, {10, 18, 0}, 0.9f);
    builder.addCamera("ridge", {-330, float(height(-330, 150)) + 25, 150}, {150, 20, -120}, 0.9f);
    builder.addCamera("above", {0, 700, 900}, {0, 0, 0}, 0.9f);
    Material ground = plain("ground", glm::vec3(1), 0, 0.95f);
    const std::uint32_t soil = builder.add(ground);
    const std::uint32_t bark = builder.add(plain("conifer", glm::vec3(1), 0, 0.9f));
    const std::uint32_t granite = builder.add(plain("granite", glm::vec3(1), 0, 0.85f));
    std::vector<std::uint32_t> tiles, trees, rocks;
    for (std::uint32_t row = 0; row < kTiles; ++row)
        for (std::uint32_t column = 0; column < kTiles; ++column)
            tiles.push_back(builder.add(fmt::format("ground {} {}", column, row),
                                        terrainTile(column, row), soil));
    for (int i = 0; i < 3; ++i) {
        trees.push_back(builder.add(fmt::format("conifer {}", i), conifer(i), bark));
        rocks.push_back(builder.add(fmt::format("rock {}", i), rock(i), granite));
    }

    Scene scene = std::move(builder).finish();
    // The cameras have their nodes; this one, which places nothing, comes first.
    scene.nodes.insert(scene.nodes.begin(), Node{.name = "world"});
    for (SceneCamera& camera : scene.cameras) ++camera.node;
    for (const std::uint32_t tile : tiles) place(scene, tile, glm::mat4(1));
    Random random(42);
    scene.instances.reserve(tiles.size() + objects);
    while (scene.instances.size() < tiles.size() + objects) {
        const double x = random(-0.49, 0.49) * kSide, z = random(-0.49, 0.49) * kSide;
        const double turn = random(0, 2 * pi), size = random(0.7, 1.35), kind = random();
        const double y = height(x, z), up = normalAt(x, z).y;
        const auto which = static_cast<std::size_t>(kind * 3);
        if (y > kValley && y < kTreeLine && up > 0.72 && random() < 0.85)
            place(scene, trees[which], standing({x, y, z}, turn, size));
        else if (random() < 0.25)
            place(scene, rocks[which], standing({x, y + 0.1, z}, turn, size * 1.1));
    }
    return scene;
}

Scene buildInstances(std::uint64_t count) {
    SceneBuilder builder(fmt::format("builtin:instances:{}", count));
    // About 100 m by 100 m of the plain, from straight enough above that all of it is seen.
    builder.addCamera("near", {0, 80, 60}, {0, 0, 0}, 0.9f);
    const float side = std::sqrt(float(count));
    builder.addCamera("all", {0, 0.8f * side + 5, 0.9f * side + 5}, {0, 0, 0}, 0.9f);
    const auto add = [&](const char* name, Mesh mesh, glm::vec3 color) {
        return builder.add(name, std::move(mesh), builder.add(plain(name, color, 0, 0.6f)));
    };
    const std::uint32_t kinds[]{
        add("ball", patch(sphere(0.35), 32, 16, {1, 1}), {0.7f, 0.2f, 0.15f}),
        add("knot", patch(torusKnot(0.42, 0.09), 16, 96, {1, 1}), {0.15f, 0.35f, 0.7f}),
        add("rock", rock(4), {0.6f, 0.6f, 0.6f}), add("tree", conifer(4), {1, 1, 1})};
    Scene scene = std::move(builder).finish();
    scene.nodes.insert(scene.nodes.begin(), Node{.name = "world"});
    for (SceneCamera& camera : scene.cameras) ++camera.node;
    Random random(7);
    const auto across = static_cast<std::uint64_t>(std::ceil(std::sqrt(double(count))));
    scene.instances.reserve(count);
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto kind = static_cast<std::size_t>(random() * 4);
        const double x = double(i % across) - 0.5 * double(across) + random(-0.2, 0.2);
        const double z = double(i / across) - 0.5 * double(across) + random(-0.2, 0.2);
        const double size = kind == 3 ? random(0.08, 0.16) : kind == 2 ? 0.35 : random(0.7, 1.2);
        place(scene, kinds[kind], standing({x, 0.35, z}, random(0, 2 * pi), size));
    }
    return scene;
}

}  // namespace lodestar::scene::procedural

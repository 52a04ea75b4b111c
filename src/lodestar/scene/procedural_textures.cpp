// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/procedural_textures.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <stb_perlin.h>

namespace lodestar::scene::procedural {
namespace {

constexpr int kSize = 512;

/// A value in [0, 1) for a cell of a pattern.
float cellValue(glm::ivec2 cell, std::uint32_t seed) {
    std::uint32_t h = static_cast<std::uint32_t>(cell.x) * 0x9e3779b1u ^
                      static_cast<std::uint32_t>(cell.y) * 0x85ebca77u ^ seed * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return static_cast<float>((h ^ h >> 15) >> 8) / static_cast<float>(1 << 24);
}

std::uint8_t code(float value) {
    return static_cast<std::uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255 + 0.5f);
}

/// A grid of rounded tiles: which one a point is in, and how far from the joint (0 in the joint, 1
/// on the tile's face).
struct Tile {
    glm::ivec2 cell{0};
    float face = 0;
};

/// `bond` shifts every other row by this share of a tile; `joint` and `bevel` in texture widths.
Tile tileAt(glm::vec2 at, glm::ivec2 count, float bond, float joint, float bevel) {
    const glm::vec2 n(count);
    glm::vec2 p = at * n;
    const int row = (static_cast<int>(std::floor(p.y)) % count.y + count.y) % count.y;
    p.x += bond * static_cast<float>(row % 2);
    const glm::vec2 local = glm::fract(p);
    const glm::vec2 edge = glm::min(local, 1.0f - local) / n;  // distance to the border
    const int column = (static_cast<int>(std::floor(p.x)) % count.x + count.x) % count.x;
    return {{column, row},
            glm::smoothstep(0.5f * joint, 0.5f * joint + bevel, std::min(edge.x, edge.y))};
}

glm::vec4 metallicRoughness(float metallic, float roughness) {
    return {1, roughness, metallic, 1};
}

/// Dark veins of marble: 1 along the lines where warped noise is 0.
float veins(glm::vec2 at, int seed) {
    const float warp = tilingNoise(at, 4, 4, seed);
    const float line = tilingNoise(at + 0.06f * warp, 2, 4, seed + 1);
    return std::exp(-18 * std::abs(line));
}

Tile floorTile(glm::vec2 at) {
    return tileAt(at, {4, 4}, 0, 0.004f, 0.003f);
}
Tile brick(glm::vec2 at) {
    return tileAt(at, {4, 8}, 0.5f, 0.010f, 0.008f);
}
Tile tessera(glm::vec2 at) {
    return tileAt(at, {16, 16}, 0, 0.006f, 0.006f);
}
bool gilt(const Tile& tile) {
    return cellValue(tile.cell, 7) < 0.7f;
}

}  // namespace

float tilingNoise(glm::vec2 at, int cells, int octaves, int seed) {
    float sum = 0, weight = 1;
    for (int octave = 0; octave < octaves && cells <= 256; ++octave, cells *= 2, weight *= 0.5f) {
        const glm::vec2 p = at * static_cast<float>(cells);
        sum += weight * stb_perlin_noise3_seed(p.x, p.y, 0.5f, cells, cells, 0, seed + octave);
    }
    return sum;
}

Image image(std::string name, int size, const std::function<glm::vec4(glm::vec2)>& color) {
    Image made;
    made.name = std::move(name);
    made.width = made.height = size;
    made.rgba.reserve(static_cast<std::size_t>(size) * static_cast<std::size_t>(size) * 4);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const glm::vec4 c = color((glm::vec2(x, y) + 0.5f) / static_cast<float>(size));
            for (int i = 0; i < 4; ++i) made.rgba.push_back(code(c[i]));
        }
    return made;
}

Image normalMap(std::string name, int size, const std::function<float(glm::vec2)>& height) {
    const float h = 0.5f / static_cast<float>(size);
    return image(std::move(name), size, [&](glm::vec2 at) {
        const float right = height(at + glm::vec2(h, 0)) - height(at - glm::vec2(h, 0));
        const float down = height(at + glm::vec2(0, h)) - height(at - glm::vec2(0, h));
        // Green points up the image, against v.
        const glm::vec3 n = glm::normalize(glm::vec3(-right, down, 2 * h));
        return glm::vec4(0.5f + 0.5f * n, 1);
    });
}

Surfacing checkerFloor() {
    Surfacing made;
    made.baseColor = image("floor", kSize, [](glm::vec2 at) {
        const Tile tile = floorTile(at);
        const bool dark = (tile.cell.x + tile.cell.y) % 2 != 0;
        const float shade = 0.06f * (cellValue(tile.cell, 1) - 0.5f);
        // Each tile is cut from another part of the slab.
        const float vein = veins(at + 0.37f * glm::vec2(tile.cell), dark ? 40 : 20);
        const glm::vec3 light = glm::vec3(0.86f, 0.82f, 0.75f) - 0.22f * vein + shade;
        const glm::vec3 deep = glm::vec3(0.16f, 0.24f, 0.22f) + 0.25f * vein + shade;
        return glm::vec4(glm::mix(glm::vec3(0.35f, 0.33f, 0.30f), dark ? deep : light, tile.face),
                         1);
    });
    made.normal = normalMap("floor normal", kSize, [](glm::vec2 at) {
        return 0.0015f * floorTile(at).face + 0.0001f * tilingNoise(at, 16, 2, 3);
    });
    made.metallicRoughness = image("floor roughness", kSize, [](glm::vec2 at) {
        const float worn = 0.22f + 0.12f * tilingNoise(at, 4, 4, 9);
        return metallicRoughness(0, glm::mix(0.9f, worn, floorTile(at).face));
    });
    return made;
}

Surfacing stone() {
    Surfacing made;
    made.baseColor = image("stone", kSize, [](glm::vec2 at) {
        const float tone = 0.05f * tilingNoise(at, 4, 5, 60) - 0.10f * veins(at, 70);
        return glm::vec4(glm::vec3(0.80f, 0.75f, 0.67f) + tone * glm::vec3(1, 1.05f, 1.15f), 1);
    });
    made.normal = normalMap("stone normal", kSize, [](glm::vec2 at) {
        return 0.002f * tilingNoise(at, 16, 4, 80) +
               0.0008f * std::max(0.0f, tilingNoise(at, 32, 2, 81));
    });
    made.metallicRoughness = image("stone roughness", kSize / 2, [](glm::vec2 at) {
        return metallicRoughness(0, 0.62f + 0.15f * tilingNoise(at, 8, 3, 82));
    });
    return made;
}

Surfacing bricks() {
    Surfacing made;
    made.baseColor = image("bricks", kSize, [](glm::vec2 at) {
        const Tile tile = brick(at);
        const float tone =
            0.25f * (cellValue(tile.cell, 2) - 0.5f) + 0.08f * tilingNoise(at, 16, 3, 90);
        const glm::vec3 clay = glm::vec3(0.62f, 0.37f, 0.27f) + tone * glm::vec3(0.8f, 0.6f, 0.5f);
        const glm::vec3 mortar =
            glm::vec3(0.66f, 0.63f, 0.58f) + 0.06f * tilingNoise(at, 32, 2, 91);
        return glm::vec4(glm::mix(mortar, clay, tile.face), 1);
    });
    made.normal = normalMap("bricks normal", kSize, [](glm::vec2 at) {
        const Tile tile = brick(at);
        return tile.face * (0.008f + 0.003f * cellValue(tile.cell, 3)) +
               0.0015f * tilingNoise(at, 16, 3, 92);
    });
    made.metallicRoughness = image("bricks roughness", kSize / 2, [](glm::vec2 at) {
        return metallicRoughness(0, 0.92f - 0.15f * brick(at).face);
    });
    return made;
}

Surfacing mosaic() {
    Surfacing made;
    made.baseColor = image("mosaic", kSize, [](glm::vec2 at) {
        const Tile tile = tessera(at);
        const float tone = 0.16f * (cellValue(tile.cell, 5) - 0.5f);
        const glm::vec3 color =
            (gilt(tile) ? glm::vec3(0.95f, 0.76f, 0.38f) : glm::vec3(0.12f, 0.26f, 0.55f)) + tone;
        return glm::vec4(glm::mix(glm::vec3(0.30f, 0.27f, 0.23f), color, tile.face), 1);
    });
    made.normal = normalMap("mosaic normal", kSize, [](glm::vec2 at) {
        const Tile tile = tessera(at);
        // Every piece is set a little askew, which is what makes a mosaic glitter.
        const glm::vec2 local = glm::fract(at * 16.0f) - 0.5f;
        const glm::vec2 tilt(cellValue(tile.cell, 11) - 0.5f, cellValue(tile.cell, 12) - 0.5f);
        return tile.face * (0.006f + 0.012f * glm::dot(local, tilt));
    });
    made.metallicRoughness = image("mosaic roughness", kSize, [](glm::vec2 at) {
        const Tile tile = tessera(at);
        return metallicRoughness(gilt(tile) ? tile.face : 0, glm::mix(0.95f, 0.28f, tile.face));
    });
    return made;
}

Image turf() {
    return image("turf", kSize / 2, [](glm::vec2 at) {
        const float blades = tilingNoise(at, 32, 3, 110), patches = tilingNoise(at, 4, 3, 111);
        const glm::vec3 color =
            glm::mix(glm::vec3(0.36f, 0.42f, 0.20f), glm::vec3(0.52f, 0.47f, 0.30f),
                     glm::clamp(0.5f + patches, 0.0f, 1.0f));
        return glm::vec4(color + 0.10f * blades, 1);
    });
}

Image lattice() {
    return image("lattice", kSize / 2, [](glm::vec2 at) {
        const glm::vec2 diagonal(4 * (at.x + at.y), 4 * (at.x - at.y));
        const glm::vec2 off = glm::abs(glm::fract(diagonal) - 0.5f);
        const float bar = std::max(off.x, off.y);  // 0.5 on the middle of a bar
        const float knot = std::min(off.x, off.y);
        const float alpha = glm::smoothstep(0.40f, 0.43f, bar);
        return glm::vec4(glm::vec3(0.42f, 0.30f, 0.17f) * (0.75f + 0.5f * knot), alpha);
    });
}

}  // namespace lodestar::scene::procedural

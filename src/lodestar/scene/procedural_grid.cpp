// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/scene/procedural_parts.hpp>
#include <lodestar/scene/procedural_scenes.hpp>
#include <lodestar/scene/procedural_textures.hpp>

namespace lodestar::scene::procedural {
namespace {

constexpr std::uint32_t kMaxTileQuads =
    255;  // a side: 256² vertices, so that 16-bit indices would do
constexpr std::uint32_t kDistinctTiles = 4;  // a side: what bounds the memory, at 2.1 M triangles
constexpr float kCell = 0.1f;                // metres a quad

/// Tiles of the field. All have the same number of quads, but a lone one may end within a row.
struct Layout {
    std::uint32_t columns = 1, rows = 1;  // tiles
    std::uint32_t across = 1, down = 1;   // whole quads a tile
    std::uint32_t rest = 0;               // triangles of one more, unfinished row

    std::uint32_t distinctColumns() const { return std::min(columns, kDistinctTiles); }
    std::uint32_t distinctRows() const { return std::min(rows, kDistinctTiles); }
};

std::uint32_t tilesFor(double quads) {
    return static_cast<std::uint32_t>(std::max(1.0, std::ceil(quads / kMaxTileQuads)));
}

Layout layoutFor(std::uint64_t triangles) {
    Layout layout;
    if (triangles <= 2ull * kMaxTileQuads * kMaxTileQuads) {
        layout.across = static_cast<std::uint32_t>(std::ceil(std::sqrt(double(triangles) / 2)));
        layout.down = static_cast<std::uint32_t>(triangles / (2 * layout.across));
        layout.rest = static_cast<std::uint32_t>(triangles % (2 * layout.across));
        return layout;
    }
    // Near a square; the second side takes up the rounding of the first.
    const double side = std::sqrt(double(triangles) / 2);
    layout.columns = tilesFor(side);
    layout.across = static_cast<std::uint32_t>(std::lround(side / layout.columns));
    const double depth = double(triangles) / 2 / (double(layout.columns) * layout.across);
    layout.rows = tilesFor(depth);
    layout.down = static_cast<std::uint32_t>(std::lround(depth / layout.rows));
    return layout;
}

/// Heights on the grid points of the distinct tiles; the field has their size as its period.
class Heights {
public:
    Heights(std::uint32_t width, std::uint32_t depth)
        : width(width), depth(depth), samples(std::size_t(width) * depth) {
        const float size = kCell * static_cast<float>(std::max(width, depth));
        const float finest =
            static_cast<float>(std::min(width, depth)) / 4;  // bumps the quads resolve
        int octaves = 0;
        for (int cells = 2; octaves < 6 && static_cast<float>(cells) <= finest; cells *= 2)
            ++octaves;
        for (std::uint32_t z = 0; z < depth; ++z)
            for (std::uint32_t x = 0; x < width; ++x)
                samples[std::size_t(z) * width + x] =
                    0.06f * size *
                    tilingNoise({float(x) / float(width), float(z) / float(depth)}, 2, octaves, 5);
    }

    /// At any grid point, also beyond the period (x, z ≥ −1).
    float at(std::int64_t x, std::int64_t z) const {
        return samples[static_cast<std::size_t>((z + depth) % depth) * width +
                       static_cast<std::size_t>((x + width) % width)];
    }

private:
    std::uint32_t width, depth;
    std::vector<float> samples;
};

/// How often the texture repeats over a tile: about every 4 m, and whole, so that tiles join.
float repeats(std::uint32_t quads) {
    return std::max(1.0f, std::round(kCell * static_cast<float>(quads) / 4));
}

Vertex vertexAt(const Heights& heights, const Layout& layout, std::uint32_t x, std::uint32_t z,
                std::uint32_t originX, std::uint32_t originZ) {
    const std::int64_t gx = originX + x, gz = originZ + z;
    const float slopeX = (heights.at(gx + 1, gz) - heights.at(gx - 1, gz)) / (2 * kCell);
    const float slopeZ = (heights.at(gx, gz + 1) - heights.at(gx, gz - 1)) / (2 * kCell);
    Vertex vertex;
    vertex.position = {kCell * static_cast<float>(x), heights.at(gx, gz),
                       kCell * static_cast<float>(z)};
    vertex.normal = glm::normalize(glm::vec3(-slopeX, 1, -slopeZ));
    vertex.tangent = glm::vec4(glm::normalize(glm::vec3(1, slopeX, 0)), 1);
    vertex.uv0 = glm::vec2(x, z) / glm::vec2(layout.across, std::max(1u, layout.down)) *
                 glm::vec2(repeats(layout.across), repeats(layout.down));
    vertex.uv1 = vertex.uv0;
    return vertex;
}

Mesh tile(const Heights& heights, const Layout& layout, std::uint32_t column, std::uint32_t row) {
    Mesh mesh;
    const std::uint32_t stride = layout.across + 1;
    const std::uint32_t triangles = 2 * layout.across * layout.down + layout.rest;
    const std::uint32_t lastRow = layout.rest > 0 ? layout.rest / 2 + 1 : 0;  // vertices of it
    const std::uint32_t vertices = stride * (layout.down + 1) + lastRow;
    for (std::uint32_t i = 0; i < vertices; ++i)
        mesh.vertices.push_back(vertexAt(heights, layout, i % stride, i / stride,
                                         column * layout.across, row * layout.down));
    mesh.indices.reserve(std::size_t(triangles) * 3);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const std::uint32_t quad = i / 2;
        const std::uint32_t back = quad / layout.across * stride + quad % layout.across;
        const std::uint32_t front = back + stride;  // +z is towards the viewer
        if (i % 2 == 0)
            mesh.indices.insert(mesh.indices.end(), {back, front, back + 1});
        else
            mesh.indices.insert(mesh.indices.end(), {back + 1, front, front + 1});
    }
    return mesh;
}

}  // namespace

Scene buildGrid(std::uint64_t triangles) {
    const Layout layout = layoutFor(triangles);
    const std::uint32_t across = layout.distinctColumns(), down = layout.distinctRows();
    const Heights heights(across * layout.across, std::max(1u, down * layout.down));

    SceneBuilder builder(fmt::format("builtin:grid:{}", triangles));
    Material ground = plain("ground", glm::vec3(1), 0, 0.85f);
    ground.baseColorTexture = builder.add(turf(), ColorSpace::srgb);
    const std::uint32_t material = builder.add(ground);
    for (std::uint32_t row = 0; row < down; ++row)
        for (std::uint32_t column = 0; column < across; ++column)
            builder.add(fmt::format("tile {} {}", column, row), tile(heights, layout, column, row),
                        material);

    const glm::vec2 tileSize = kCell * glm::vec2(layout.across, layout.down);
    const glm::vec2 size = tileSize * glm::vec2(layout.columns, layout.rows);
    for (std::uint32_t row = 0; row < layout.rows; ++row)
        for (std::uint32_t column = 0; column < layout.columns; ++column) {
            const glm::vec2 corner = tileSize * glm::vec2(column, row) - 0.5f * size;
            builder.place(row % down * across + column % across, {corner.x, 0, corner.y});
        }
    const float reach = std::max({size.x, size.y, kCell});
    builder.addCamera("above", {0, 0.45f * reach, 0.75f * reach}, {0, 0, 0.05f * reach}, 0.8f);
    builder.addCamera("ground", {0, 0.09f * reach, 0.5f * reach}, {0, 0, -0.1f * reach}, 0.9f);
    return std::move(builder).finish();
}

}  // namespace lodestar::scene::procedural

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <glm/glm.hpp>

#include <lodestar/scene/scene.hpp>

/// Texture images made in code. All of them tile.
namespace lodestar::scene::procedural {

/// Sum of `octaves` of noise of period 1, the first with `cells` (a power of two ≤ 64) bumps across
/// it; about −1 … 1.
float tilingNoise(glm::vec2 at, int cells, int octaves, int seed);

/// Evaluates `color` (stored values 0 … 1) at the centre of every texel of [0, 1)².
Image image(std::string name, int size, const std::function<glm::vec4(glm::vec2)>& color);

/// Tangent-space normals of a height field; `height` is in texture widths and has period 1.
Image normalMap(std::string name, int size, const std::function<float(glm::vec2)>& height);

/// A material's set of images.
struct Surfacing {
    Image baseColor, normal, metallicRoughness;
};

Surfacing checkerFloor();  ///< 4 × 4 marble tiles with dull joints
Surfacing stone();         ///< pale and veined
Surfacing bricks();        ///< 4 × 8 bricks in running bond
Surfacing mosaic();        ///< 16 × 16 small gilt and blue tiles
Image turf();              ///< base colour of open ground
Image lattice();           ///< base colour with alpha 0 between crossed bars

}  // namespace lodestar::scene::procedural

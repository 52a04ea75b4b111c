// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

/// Linear value of an 8-bit code, and the code nearest to a linear value (clamped to 0…1).
float linearFromCode(std::uint8_t code, ColorSpace space);
std::uint8_t codeFromLinear(float value, ColorSpace space);

/// Writes the mip levels 1, 2, … of an RGBA8 image to `levels` (each max(1, size >> level), rows
/// from the top). Colours are averaged in linear light, alpha as it is; odd sizes by exact box
/// weights. Levels are made from the unrounded level before.
void writeMips(const std::uint8_t* base, int width, int height, ColorSpace space,
               const std::vector<std::uint8_t*>& levels);

/// `image` at a larger size: bilinear in linear light, or the nearest texel. Beyond the edge it
/// goes on as the wrap modes say, so that a tiling image still tiles.
std::vector<std::uint8_t> resized(const Image& image, int width, int height, ColorSpace space,
                                  Wrap wrapU, Wrap wrapV, bool nearest);

}  // namespace lodestar::scene

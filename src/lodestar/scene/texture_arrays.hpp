// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

/// At most this many 2D arrays, since shaders choose among them by a switch (the driver floor has
/// no descriptor indexing).
inline constexpr std::uint32_t kMaxTextureArrays = 8;

/// All textures of one size and colour encoding, as layers of one 2D array with a full mip chain.
struct TextureArray {
    int width = 0, height = 0;
    std::uint32_t layers = 0, mipLevels = 0;
    ColorSpace space = ColorSpace::linear;
    /// RGBA8, mip-major: all layers of level 0, then all layers of level 1, …; rows from the top.
    std::vector<std::uint8_t> texels;

    std::size_t levelOffset(std::uint32_t level) const;  ///< byte offset of `level` in texels
};

struct TextureSlot {
    std::uint32_t array = 0, layer = 0;
};

struct TextureArrays {
    std::vector<TextureArray> arrays;  ///< ≤ kMaxTextureArrays
    std::vector<TextureSlot> slotOf;   ///< one for each Scene::textures entry
};

/// Sorts the scene's textures into arrays by size and colour space and builds their mips, averaging
/// in linear light (sRGB colours are decoded first; alpha is always linear). Textures that read the
/// same image in the same colour space share a layer. When there are more sizes than arrays, sizes
/// of one colour space are joined, the pair first whose union adds the fewest texels, so small ones
/// go up to the next; no image shrinks. Odd sizes are averaged with exact box weights. An array has
/// at most 2048 layers; more of one size go to a second array.
///
/// Throws std::invalid_argument where an image is not width × height texels, a texture names no
/// image, or there are more textures than kMaxTextureArrays × 2048.
TextureArrays buildTextureArrays(const Scene&);

}  // namespace lodestar::scene

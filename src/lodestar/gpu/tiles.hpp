// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/buffer.hpp>

namespace lodestar::gpu {

/// Tiles of 8×8 texels of a grid that passes work on in place of the whole grid: see
/// Recorder::dispatchTiles. Listed by the device, which alone knows how many there are.
struct TileList {
    /// Room for all tiles of `grid`.
    TileList(const Device& device, vk::Extent2D grid, const std::string& name)
        : groups(device, name + ": groups", 3 * sizeof(std::uint32_t)),
          tiles(device, name, (1 + tilesOf(grid)) * sizeof(std::uint32_t), vk::Format::eR32Uint) {}

    Buffer groups;      ///< workgroups that cover the list: three words of an indirect dispatch
    TexelBuffer tiles;  ///< R32_UINT: how many; then the place of each in tiles, x | y << 16

private:
    static std::uint64_t tilesOf(vk::Extent2D grid) {
        return std::uint64_t{(grid.width + 7) / 8} * ((grid.height + 7) / 8);
    }
};

}  // namespace lodestar::gpu

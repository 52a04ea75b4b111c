// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lodestar::quality {

/// An sRGB-encoded picture, 8 bits a channel, rows from the top.
struct RgbImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;  ///< 3 · width · height

    RgbImage() = default;
    RgbImage(int w, int h) : width(w), height(h), rgb(std::size_t(3) * w * h) {}
    const std::uint8_t* at(int x, int y) const { return &rgb[3 * (std::size_t(y) * width + x)]; }
    std::uint8_t* at(int x, int y) { return &rgb[3 * (std::size_t(y) * width + x)]; }
};

/// One number a pixel, e.g. an error map.
struct ScalarImage {
    int width = 0, height = 0;
    std::vector<float> values;
};

}  // namespace lodestar::quality

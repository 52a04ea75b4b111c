// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <lodestar/quality/image.hpp>

namespace lodestar::app {

/// One byte a pixel: 1 where a depth discontinuity lies within `radius` pixels. `depth` is linear
/// view depth, 0 = background. Two 4-neighbours are a discontinuity when one of them alone is
/// background, or when their depths differ by more than `jump` of the nearer one; the distance is
/// Euclidean, from either of the two.
std::vector<std::uint8_t> depthEdgeMask(std::span<const float> depth, int width, int height,
                                        float jump = 0.05f, int radius = 2);

struct Region {
    int x = 0, y = 0, width = 0, height = 0;
};

/// The region of that size (or the whole picture, when it is smaller) with the largest summed
/// squared error inside the mask.
Region worstRegion(const quality::RgbImage& reference, const quality::RgbImage& test,
                   const std::vector<std::uint8_t>& mask, int width, int height);

/// The same region of each picture, every pixel `zoom` times as large, side by side.
quality::RgbImage cropsSideBySide(const std::vector<const quality::RgbImage*>&, const Region&,
                                  int zoom);

}  // namespace lodestar::app

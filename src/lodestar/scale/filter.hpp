// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace lodestar::scale {

/// How a picture of one size becomes one of another.
enum class Filter {
    point,         ///< the nearest texel
    bilinear,      ///< tent over the 2×2 nearest
    bicubic,       ///< cubic B-spline over 4×4 by four bilinear fetches (Sigg & Hadwiger 2005)
    noise,         ///< the nearest texel and a little grain, which breaks up the steps of edges
    noiseOffset,   ///< bilinear, read a random part of a texel away
    edgeAdaptive,  ///< bilinear that turns along edges and is steeper across them
};

inline constexpr std::array<std::string_view, 6> kFilterNames{
    "point", "bilinear", "bicubic", "noise", "noise-offset", "edge-adaptive"};

}  // namespace lodestar::scale

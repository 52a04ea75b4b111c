// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace lodestar::upsample {

/// How grid O is made from grid S: a domain filter f, and whether depth and normal guide it.
enum class Reconstruct {
    bilateral,    ///< tent over the 2×2 nearest, guided: the paper's filter
    bilinear,     ///< the same tent, not guided: conventional resizing
    biquadratic,  ///< quadratic B-spline over 3×3, guided
    bicubic,      ///< cubic B-spline over 4×4, guided
    gaussian,     ///< Gaussian (σ = 0.7 texels of S) over 4×4, guided
    nearest,      ///< the nearest texel, not guided
    /// of the 2×2 nearest the one most like in depth; their tent where all are like within 3 σz
    /// (Jansen & Bavoil 2011): the usual cheap competitor
    nearestDepth,
};

inline constexpr std::array<std::string_view, 7> kReconstructNames{
    "bilateral", "bilinear", "biquadratic", "bicubic", "gaussian", "nearest", "nearest-depth"};

/// What a texel of S keeps of what was shaded there.
enum class Packing {
    full,  ///< halves, and depth as a float: 16 bytes
    /// what the paper's RGBA16 target holds: values in 8 bits, depth in 16, the normal's x and y in
    /// 8 each. Stored as `full` is, so that its quality can be compared, not its memory.
    yang,
};

/// Widths of the range filters: how unlike a tap may be. Both scale-free; infinity switches one
/// off.
struct Sigmas {
    float z = 0.02f;  ///< of the depth difference relative to the pixel's own depth
    float n = 0.4f;   ///< of the difference of foreshortened normals (nx/nz, ny/nz, 1)
};

}  // namespace lodestar::upsample

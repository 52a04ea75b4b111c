// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/buffer.hpp>
#include <lodestar/gpu/image.hpp>

namespace lodestar::visibility {

/// Some rows of grid B. Grid C, which has s rows for each, exists only for a band at a time.
struct Band {
    std::uint32_t index = 0;  ///< from 0, from the top
    std::uint32_t firstRow = 0, rows = 0;
};

/// What every capture backend leaves behind: an id for each sample of a band of grid C, rows from
/// the top. One of the two.
struct Samples {
    const gpu::Image* ids = nullptr;  ///< R32_UINT, s·w × s·rows or more
    /// RGBA32_UINT, two samples a texel: id, depth bits, id, depth bits; s·w samples a row
    const gpu::TexelView* pairs = nullptr;
};

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include <lodestar/post/effective_params.h>
#include <lodestar/gpu/image.hpp>

/// What the effects that are computed on grid B share.
namespace lodestar::post {

/// Grid B of `size` texels over a grid O of `full` pixels, `rate` of which make a texel.
inline shared::EffectiveGrid effectiveGrid(vk::Extent2D size, vk::Extent2D full, glm::vec2 rate) {
    return {.size = {size.width, size.height}, .fullSize = {full.width, full.height}, .rate = rate};
}

/// Throws std::invalid_argument naming `what` unless `ok`.
inline void require(bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(what);
}

}  // namespace lodestar::post

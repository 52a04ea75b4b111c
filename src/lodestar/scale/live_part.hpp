// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/image.hpp>

namespace lodestar::scale {

/// How far along each axis a bilinear fetch of the part `live` of a target may go [texels]. Where
/// more texels follow it stays short of the centre of the last one: there it would read the next
/// one too, with a weight of 0, and 0 · NaN is NaN. Hardware places samples to 1/256 texel.
inline glm::vec2 lastRead(vk::Extent2D live, vk::Extent2D whole) {
    const auto along = [](std::uint32_t n, std::uint32_t of) {
        return static_cast<float>(n) - 0.5f - (n < of ? 1.0f / 256 : 0.0f);
    };
    return {along(live.width, whole.width), along(live.height, whole.height)};
}

}  // namespace lodestar::scale

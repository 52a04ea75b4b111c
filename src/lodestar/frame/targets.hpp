// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include <lodestar/budget/levers.hpp>
#include <lodestar/gpu/image.hpp>

namespace lodestar::frame {

inline constexpr float kLeastScale = 0.5f, kMostScale = 2;

/// Whether both axes lie between kLeastScale and `most`.
inline bool isRenderScale(budget::AxisScale s, budget::AxisScale most) {
    return s.x >= kLeastScale && s.y >= kLeastScale && s.x <= most.x && s.y <= most.y;
}

/// `size` at a render scale, at least a pixel and at most what a target can be.
inline vk::Extent2D scaled(vk::Extent2D size, budget::AxisScale scale) {
    const auto along = [](std::uint32_t n, float s) {
        return std::clamp(static_cast<std::uint32_t>(std::lround(static_cast<float>(n) * s)), 1u,
                          16384u);
    };
    return {along(size.width, scale.x), along(size.height, scale.y)};
}

/// An image that passes write and read, and that can be read back.
inline gpu::Image target(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                         const char* name, vk::ImageUsageFlags extra = {}) {
    return {
        device,
        {.name = name,
         .format = format,
         .extent = extent,
         .usage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferSrc | extra}};
}

}  // namespace lodestar::frame

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include <lodestar/gpu/image.hpp>

namespace lodestar::frame {

inline constexpr float kLeastScale = 0.5f, kMostScale = 2;

/// `size` at a render scale, at least a pixel and at most what a target can be.
inline vk::Extent2D scaled(vk::Extent2D size, float scale) {
    const auto along = [&](std::uint32_t n) {
        return std::clamp(static_cast<std::uint32_t>(std::lround(static_cast<float>(n) * scale)),
                          1u, 16384u);
    };
    return {along(size.width), along(size.height)};
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

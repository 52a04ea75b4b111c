// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/device.hpp>

namespace lodestar::gpu {

/// Bilinear, clamped to the edge.
inline vk::raii::Sampler makeLinearSampler(const Device& device) {
    constexpr auto kClamp = vk::SamplerAddressMode::eClampToEdge;
    return {device.vk(), vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear,
                                               .minFilter = vk::Filter::eLinear,
                                               .addressModeU = kClamp,
                                               .addressModeV = kClamp}};
}

}  // namespace lodestar::gpu

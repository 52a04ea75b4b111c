// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/device.hpp>

namespace lodestar::shading {

/// Of the sky's map: between texels and between levels of roughness.
inline vk::raii::Sampler makeSkySampler(const gpu::Device& device) {
    constexpr auto kClamp = vk::SamplerAddressMode::eClampToEdge;
    return {device.vk(), vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear,
                                               .minFilter = vk::Filter::eLinear,
                                               .mipmapMode = vk::SamplerMipmapMode::eLinear,
                                               .addressModeU = kClamp,
                                               .addressModeV = kClamp,
                                               .maxLod = VK_LOD_CLAMP_NONE}};
}

}  // namespace lodestar::shading

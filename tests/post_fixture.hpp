// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <glm/gtc/packing.hpp>

#include <lodestar/gpu/readback.hpp>

#include "gpu_device.hpp"

namespace lodestar::post {

inline vk::Extent2D extentOf(glm::ivec2 size) {
    return {std::uint32_t(size.x), std::uint32_t(size.y)};
}

/// Pictures for the effects: what lies beside their live part is NaN.
class PostTest : public GpuTest {
protected:
    /// `live` in the corner of a target of `whole`, whose rest is `rest`.
    template <typename T>
    static gpu::Image target(vk::Format format, glm::ivec2 live, glm::ivec2 whole,
                             const std::vector<T>& in, T rest) {
        std::vector<T> texels(std::size_t(whole.x) * whole.y, rest);
        for (int y = 0; y < live.y && !in.empty(); ++y)
            for (int x = 0; x < live.x; ++x)
                texels[std::size_t(y) * whole.x + x] = in[std::size_t(y) * live.x + x];
        gpu::Image made(
            device(),
            {.name = "test",
             .format = format,
             .extent = extentOf(whole),
             .usage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eStorage |
                      vk::ImageUsageFlagBits::eTransferDst | vk::ImageUsageFlagBits::eTransferSrc});
        gpu::uploadImage(device(), made, 0, std::as_bytes(std::span(texels)));
        return made;
    }
    static gpu::Image depths(glm::ivec2 live, glm::ivec2 whole, const std::vector<float>& z) {
        return target(vk::Format::eR32Sfloat, live, whole, z, NAN);
    }
    static gpu::Image colors(glm::ivec2 live, glm::ivec2 whole, const std::vector<glm::vec3>& rgb) {
        std::vector<std::uint64_t> halves;
        for (const glm::vec3& c : rgb) halves.push_back(glm::packHalf4x16(glm::vec4(c, 1)));
        return target(vk::Format::eR16G16B16A16Sfloat, live, whole, halves,
                      glm::packHalf4x16(glm::vec4(NAN)));
    }
    static std::vector<glm::vec3> readColors(const gpu::Image& image, glm::ivec2 live) {
        std::vector<glm::vec3> rgb;
        for (const auto bits :
             gpu::as<std::uint64_t>(gpu::readImage(device(), part(image, extentOf(live)))))
            rgb.emplace_back(glm::unpackHalf4x16(bits));
        return rgb;
    }
};

}  // namespace lodestar::post

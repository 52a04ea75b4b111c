// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include <lodestar/post/ssao_options.hpp>

/// The effects' equations in double precision, for tests. Free of Vulkan. Rows from the top.
namespace lodestar::post::reference {

/// Grid B over grid O, and the eye.
struct Grid {
    glm::ivec2 size{1}, fullSize{1};
    glm::dvec2 rate{1};
    glm::dvec2 clipScale{1}, jitter{0};

    std::size_t index(glm::ivec2 texel) const {
        return static_cast<std::size_t>(texel.y) * static_cast<std::size_t>(size.x) +
               static_cast<std::size_t>(texel.x);
    }
    glm::ivec2 clamped(glm::ivec2 texel) const {
        return glm::clamp(texel, glm::ivec2(0), size - 1);
    }
    glm::dvec2 centreOnO(glm::ivec2 texel) const;
    glm::dvec3 viewPoint(glm::ivec2 texel, double z) const;
};

/// Share of the ambient light that is occluded, of every texel: what Ssao writes.
std::vector<double> ssao(const Grid&, const std::vector<double>& depth,
                         const std::vector<glm::dvec3>& normal, const SsaoOptions&);

}  // namespace lodestar::post::reference

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <glm/glm.hpp>

/// Stands for the host's own renderer: three balls on a plain, by ray casting on the CPU.
namespace tiny {

/// What a host has of each pixel: cheap, and at full resolution.
struct GBuffer {
    int width = 0, height = 0;
    std::vector<float> depth;       ///< linear view depth, 0 = background
    std::vector<glm::vec3> normal;  ///< view space
    std::vector<glm::vec3> albedo;  ///< linear
};
GBuffer drawGBuffer(int width, int height);

/// Light that arrives at the middles of the texels of a coarse grid, with an area light's soft
/// shadow: dear, and smooth within a surface. Grid of ⌈width/rate⌉ × ⌈height/rate⌉.
struct Lighting {
    int width = 0, height = 0;
    std::vector<glm::vec3> light;  ///< linear
    std::vector<float> depth;      ///< of the point lit, as in GBuffer
    std::vector<glm::vec3> normal;
};
Lighting shade(int width, int height, float rate);

}  // namespace tiny

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <glm/glm.hpp>

namespace lodestar::post {

/// The exposure that brings the geometric mean of the picture's luminance to the key of an average
/// scene (Reinhard et al. 2002), between 1/4 and 16. Texels of alpha 0 (unlit surfaces, which no
/// exposure changes) do not count; 1 when nothing does. Free of Vulkan.
float meteredExposure(std::span<const glm::vec4> radiance);

}  // namespace lodestar::post

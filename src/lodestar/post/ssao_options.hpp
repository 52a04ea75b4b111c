// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace lodestar::post {

struct SsaoOptions {
    float radius = 1;    ///< R, how far occluders matter [scene units], > 0
    float strength = 2;  ///< factor of the mean over the samples; occlusion is clamped to 1
    float bias = 0.05f;  ///< cosine above the surface from which something occludes; the thesis: 0
    std::uint32_t samples = 12;  ///< of a texel, 1 … 64; nine texels share what they found
};

}  // namespace lodestar::post

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace lodestar::upsample {

/// exp(−d²/2σ²) = exp2(−falloff · d²); 0 for σ = ∞.
inline float falloff(float sigma, const char* name) {
    if (!(sigma > 0)) throw std::invalid_argument(std::string("Sigmas::") + name + " must be > 0");
    return std::isinf(sigma) ? 0.0f : 1.44269504f / (2 * sigma * sigma);
}

}  // namespace lodestar::upsample

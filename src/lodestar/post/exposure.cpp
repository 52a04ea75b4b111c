// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/exposure.hpp>

#include <algorithm>
#include <cmath>

namespace lodestar::post {

float meteredExposure(std::span<const glm::vec4> radiance) {
    constexpr double kKey = 0.12;
    constexpr double kDarkest = 1e-3;  // black is not infinitely dark to a meter
    double sum = 0;
    std::size_t count = 0;
    for (const glm::vec4& texel : radiance) {
        if (texel.w == 0) continue;
        const double luminance = 0.2126 * texel.x + 0.7152 * texel.y + 0.0722 * texel.z;
        sum += std::log(std::max(luminance, kDarkest));
        ++count;
    }
    if (count == 0) return 1;
    return static_cast<float>(
        std::clamp(kKey / std::exp(sum / static_cast<double>(count)), 0.25, 16.0));
}

}  // namespace lodestar::post

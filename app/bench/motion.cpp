// SPDX-License-Identifier: Apache-2.0
#include "app/bench/motion.hpp"

#include <cmath>
#include <limits>

namespace lodestar::app {

quality::MotionField motionBetween(const DepthView& before, const DepthView& now, int width,
                                   int height) {
    constexpr float kHidden = 0.01f;
    const float aspect = static_cast<float>(width) / static_cast<float>(height);
    const glm::mat4 clipFromView = now.camera.clipFromView(aspect);
    const glm::mat4 worldFromView = glm::inverse(now.camera.viewFromWorld());
    const glm::mat4 clipBefore = before.camera.clipFromView(aspect) * before.camera.viewFromWorld();
    const glm::vec2 size(width, height);
    quality::MotionField motion{width, height, {}};
    motion.offsets.assign(2 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                          std::numeric_limits<float>::quiet_NaN());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                  static_cast<std::size_t>(x);
            const float z = now.depth[i];
            if (!(z > 0)) continue;
            const glm::vec2 pixel(x, y);
            const glm::vec2 ndc = (pixel + 0.5f) / size * 2.0f - 1.0f;
            const glm::vec4 inView(ndc.x / clipFromView[0][0] * z, ndc.y / clipFromView[1][1] * z,
                                   -z, 1);
            const glm::vec4 clip = clipBefore * (worldFromView * inView);
            if (!(clip.w > 0)) continue;
            const glm::vec2 was = (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * size - 0.5f;
            const glm::ivec2 at(glm::round(was));
            if (at.x < 0 || at.y < 0 || at.x >= width || at.y >= height) continue;
            const float there =
                before.depth[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(at.x)];
            if (!(std::abs(there - clip.w) <= kHidden * clip.w)) continue;
            motion.offsets[2 * i] = was.x - pixel.x;
            motion.offsets[2 * i + 1] = was.y - pixel.y;
        }
    return motion;
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <lodestar/quality/flicker.hpp>
#include <lodestar/scene/camera.hpp>

namespace lodestar::app {

/// What a camera saw of a scene that stands still.
struct DepthView {
    scene::Camera camera;
    std::span<const float> depth;  ///< linear view depth of each pixel, 0 = background
};

/// Where the surface of each pixel of `now` was in `before`; not finite for background and for what
/// was hidden there (nearer than 1 % of the depth lies something else).
quality::MotionField motionBetween(const DepthView& before, const DepthView& now, int width,
                                   int height);

}  // namespace lodestar::app

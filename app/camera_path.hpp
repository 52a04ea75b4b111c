// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <lodestar/scene/camera.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// How the camera moves over a run.
struct CameraPath {
    enum class Kind { still, orbit, dolly, keys };
    Kind kind = Kind::still;
    float amount = 0;  ///< orbit: radians over the run; dolly: fraction of the way to the target
    std::vector<scene::Camera> keys;  ///< evenly spaced in time, blended linearly

    /// The camera of frame `index` of `count`, starting from `start`.
    scene::Camera at(const scene::Camera& start, std::size_t index, std::size_t count) const;
};

/// Reads "orbit" (once around), "orbit:DEGREES", "dolly" (half of the way), "dolly:FRACTION" or the
/// name of a JSON file: an array of {"eye": [x,y,z], "at": [x,y,z], "fov_deg": n}.
Result<CameraPath> parsePath(const std::string& text);

}  // namespace lodestar::app

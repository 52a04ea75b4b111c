// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <lodestar/budget/budget.hpp>
#include <lodestar/budget/cost_model.hpp>
#include <lodestar/budget/proportional_controller.hpp>
#include <lodestar/budget/trace.hpp>

#include "app/camera_path.hpp"
#include "app/session.hpp"

namespace lodestar::app {

/// What full quality costs from one camera, and what the shading rate does to it.
struct Calibration {
    double fullMs = 0;        ///< median at r = 1
    budget::CostModel model;  ///< through the medians at r = 2 and r = 4
};

/// Renders at r = 1, 2 and 4 in turn, the other levers as given, `rounds` times after a warm-up.
Calibration calibrate(frame::Frame&, const scene::Camera&, const budget::Levers&, int rounds);

/// A frame of a run kept for judging.
struct Sample {
    std::size_t index = 0;
    float seconds = 0;  ///< of the animation
    scene::Camera camera;
    quality::RgbImage picture;
};

struct Run {
    std::vector<budget::FrameCosts> costs;
    budget::Trace trace;  ///< filled when there is a budget
    std::vector<Sample> samples;
    std::vector<budget::Levers> levers;  ///< of every frame
    float lastRate = 1;
    scene::Camera lastCamera;
    bool saturated = false;  ///< the last frames missed the budget with r (or S) at its limit
};

struct RunOptions {
    std::size_t frames = 1;
    CameraPath path;
    double startSeconds = 0;         ///< of the animation, at the first frame
    double fps = 60;                 ///< animation time advances by 1/fps a frame
    budget::Levers levers;           ///< under a budget only their proportions count
    std::optional<double> targetMs;  ///< hold this frame time
    Calibration calibration;         ///< used with a target
    /// S holds the target, as the proportional controller says; r stays. Its target is targetMs;
    /// `levers` are the most of what it controls.
    std::optional<budget::ProportionalSettings> proportional;
    std::size_t samples = 0;  ///< pictures to keep, evenly over the run

    float secondsAt(std::size_t frame) const {
        return static_cast<float>(startSeconds + static_cast<double>(frame) / fps);
    }
};

/// Frame by frame: the levers that controllers move, the whole time and that of each pass [ms].
Json traceRows(const Run&);

/// Of the frames from `settling` on, what is controlled came to in the median: "S = 0.75, layer =
/// 0.5".
std::string mediansOf(const Run&, const budget::ScaleControls&, std::size_t settling);

/// Renders the frames; `afterFrame(i)` may read the picture back (its time does not count).
Run renderRun(const Session&, frame::Frame&, const scene::Camera& start, const RunOptions&,
              const std::function<Result<void>(std::size_t)>& afterFrame, Result<void>& outcome);

}  // namespace lodestar::app

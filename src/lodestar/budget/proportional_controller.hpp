// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/budget/levers.hpp>

namespace lodestar::budget {

/// What S moves: S itself is a factor, and each of these is given its share of it.
struct ScaleControls {
    bool render = true;   ///< Levers::renderScale: both axes, is S
    bool layer = false;   ///< Levers::layerScale: what was given, times S
    bool shadow = false;  ///< Levers::shadowScale: what was given, times S in steps of 1/8
    bool operator==(const ScaleControls&) const = default;
    bool any() const { return render || layer || shadow; }
};

struct ProportionalSettings {
    double targetMs = 16.6;        ///< T: the refresh interval of the display, or two of them
    double k = 0.25;               ///< rate of change; the loop is stable below 1
    double least = 0.5, most = 1;  ///< limits of S
    /// A frame interval longer than this many GPU times is a stall of the CPU and is ignored.
    double spike = 2;
    double hysteresis = 0;  ///< S rests while t is within this share of T
    /// S takes only this many values, evenly over its range, and moves from one to the next over
    /// some frames; 0 = any value.
    int bands = 0;
    ScaleControls controls;
};

/// The resolution controller of Binks 2011: S' = S + k·S·(T − t)/T, with t the mean of the frame's
/// GPU time and of the interval between frames. Under vertical sync the interval alone says only
/// that T is held; the GPU time alone misses what the CPU costs. Hysteresis and bands are what its
/// author suggests in the comments. docs/scale.md.
class ProportionalController {
public:
    /// Throws std::invalid_argument on settings that are not finite, targetMs ≤ 0, k outside 0 … 1,
    /// least ≤ 0, most < least, spike < 1, hysteresis or bands < 0, a startScale outside
    /// least … most, or controls of nothing.
    explicit ProportionalController(const ProportionalSettings&, double startScale = 1);

    /// The levers of the next frame, given what the last one cost. Reads gpuMs and intervalMs.
    /// Throws std::invalid_argument when either is negative or not finite.
    Levers next(const FrameCosts& measured) {
        update(measured);
        return drive({.renderScale = static_cast<float>(settings.most)});
    }
    /// next() without the levers: drive() has them.
    void update(const FrameCosts& measured);
    /// `given` with what is controlled as S now has it. `given` is the most of it: each axis of
    /// renderScale gets S, but no more than it was given or 1.
    Levers drive(const Levers& given) const;

    double scale() const { return s; }
    /// True when S is at its least and the frame still misses the target.
    bool saturated() const { return missing && s <= settings.least; }

private:
    double bandOf(double wanted) const;
    void holdShadow();

    ProportionalSettings settings;
    double s;       ///< of the last levers
    double wanted;  ///< what the law asks for; with bands s follows it
    double band;    ///< where s goes
    double shadow;  ///< S as the light maps have it: a change redraws them all
    bool missing = false;
};

}  // namespace lodestar::budget

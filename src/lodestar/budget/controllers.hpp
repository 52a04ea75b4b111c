// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>

#include <lodestar/budget/cost_model.hpp>
#include <lodestar/budget/levers.hpp>
#include <lodestar/budget/machine_speed.hpp>

namespace lodestar::budget {

struct YangSettings {
    double targetMs = 16.6;
    double k = 0;          ///< calibrated cost of the coarse terms at r = 1 [ms]
    double maxStep = 0.2;  ///< largest |Δr| from one frame to the next
    double maxRate = 8;    ///< r never grows past this: 1/64 of K is left, and the picture suffers
};

/// The frame-rate controller of Yang et al. 2008, §3: Δt = K·Δ(1/r²), |Δr| ≤ 0.2, r ≥ 1.
///
/// The paper applies its law to the last frame's time. Frame times of a busy machine are noisy
/// (some percent, now and then a frame of twice the time), and that law would pass the noise on to
/// r. So the time it works on is K/r² + C with C the median of t − K/r² over the last few frames,
/// which no single slow frame moves; three frames in a row that disagree with the older ones end
/// the history, so a real change of load is followed at once; a frame all of whose passes were slow
/// together is taken for as long as it would have been on a free machine; r rests while the
/// expected time is within 2.5 % of what it aims at (more on a noisier machine), which is 2.5 %
/// under the target, since noise only ever makes frames longer; and K is corrected by what changes
/// of r turn out to do. docs/budget.md has the figures.
class YangController {
public:
    /// Throws std::invalid_argument on settings that are not finite, targetMs ≤ 0, k < 0,
    /// maxStep ≤ 0, maxRate < 1 or a startRate outside 1 … maxRate. A k too small to matter is
    /// raised to 10 % of the target; K then grows as r is seen to work.
    explicit YangController(const YangSettings&, double startRate = 1);

    /// The levers of the next frame, given what the last one (rendered with the levers returned
    /// before) cost. `passes` may be empty: a slow machine then passes for a heavy scene. Throws
    /// std::invalid_argument when it is negative or not finite.
    Levers next(const FrameCosts& measured);

    double rate() const { return r; }
    /// True when r is at its limit and the frame still misses the target: shading is not what
    /// costs.
    bool saturated() const;
    /// What the controller holds to be true of the scene now. C is 0 before the first frame.
    CostModel model() const { return estimate; }

private:
    struct Sample {
        double x;   ///< 1/r²
        double ms;  ///< the frame's time
    };

    void learn(Sample newest);
    void forgetOldLoad();
    double medianC() const;
    double deadband() const;

    YangSettings settings;
    double r = 1;
    double kFloor = 0, kCeiling = 0;
    CostModel estimate;
    MachineSpeed machine;
    double noiseMs = 0;  ///< standard deviation of a frame's time about the model
    std::deque<Sample> history;
};

}  // namespace lodestar::budget

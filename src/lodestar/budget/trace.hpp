// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace lodestar::budget {

/// Median of `values`, the mean of the middle two when there is an even number; NaN when empty.
double median(std::vector<double> values);

/// One frame of a run under a budget.
struct TraceFrame {
    double rate = 1;  ///< the r it was rendered with
    double ms = 0;    ///< what it took
    double targetMs = 0;
};

/// What a governor did over a run, and the figures that say how well. A figure over no frames at
/// all is NaN.
class Trace {
public:
    /// Frames a governor is given to find its r before it is judged.
    static constexpr std::size_t kSettling = 15;

    /// Throws std::invalid_argument unless rate ≥ 1, ms ≥ 0 and targetMs > 0, all finite.
    void add(const TraceFrame&);
    const std::vector<TraceFrame>& frames() const { return run; }

    /// Share of the frames from `settling` on whose time is within `tolerance` of the target
    /// (0.1 = ±10 %).
    double shareWithin(double tolerance, std::size_t settling = kSettling) const;

    /// The first frame that starts ten frames of which nine are within `tolerance` of the target;
    /// none when the run never gets there.
    std::optional<std::size_t> settlingFrames(double tolerance = 0.1) const;

    /// How far the time goes past the target (under it when the run starts over it), as a fraction
    /// of it, after it first comes within 10 %; 0 when it never does. Of medians of three frames,
    /// so that one preempted frame is not overshoot.
    double overshoot() const;

    /// Share of the frames from `settling` on at which r turns from growing to shrinking or back.
    /// A turn counts once it has gone
    /// `epsilon` back.
    double turnShare(std::size_t settling = kSettling, double epsilon = 0.02) const;

    double medianMs(std::size_t settling = kSettling) const;
    double medianRate(std::size_t settling = kSettling) const;

private:
    std::vector<TraceFrame> run;
};

}  // namespace lodestar::budget

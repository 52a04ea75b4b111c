// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>

#include <lodestar/budget/levers.hpp>

namespace lodestar::budget {

/// Tells a slow machine from a heavy scene. A scene that grows heavier costs some passes more, or
/// all of them little by little as the camera comes near; a machine that is busy with something
/// else slows them all from one frame to the next.
class MachineSpeed {
public:
    /// How many times longer than lately the machine took for the same work, ≥ 1: what all passes
    /// but those that make up `kExempt` of the frame's time are slower by, against their own
    /// medians over the last `kSpan` frames. All of it counts where it is no more than noise, or
    /// part of a burst, which begins with a leap of `kLeap` and lasts `kLongest` frames at most;
    /// else what came with this very frame, since a scene may grow so from frame to frame. 1 for
    /// frames without passes and for the first few.
    double slowdown(const FrameCosts& measured);

private:
    static constexpr std::size_t kSpan = 15;
    static constexpr std::size_t kEnough = 5;  ///< frames a pass must have been seen in
    static constexpr double kExempt = 0.3;
    static constexpr double kNoise = 1.05;  ///< times as slow, as any frame may be
    static constexpr double kLeap = 1.15;   ///< from one frame to the next
    static constexpr int kLongest = 8;

    std::deque<std::vector<PassCost>> lately;
    int burst = 0;  ///< frames that it has lasted; 0: none
};

}  // namespace lodestar::budget

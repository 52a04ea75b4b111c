// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>

#include <lodestar/budget/levers.hpp>

namespace lodestar::budget {

/// Tells a slow machine from a heavy scene. A scene that grows heavier costs some passes more; a
/// machine that is busy with something else slows them all at once.
class MachineSpeed {
public:
    /// How many times longer than lately the machine took for the same work, ≥ 1: what all passes
    /// but those that make up `kExempt` of the frame's time are slower by, against their own
    /// medians over the last `kSpan` frames. 1 for frames without passes and for the first few.
    double slowdown(const FrameCosts& measured);

private:
    static constexpr std::size_t kSpan = 15;
    static constexpr std::size_t kEnough = 5;  ///< frames a pass must have been seen in
    static constexpr double kExempt = 0.3;

    std::deque<std::vector<PassCost>> lately;
};

}  // namespace lodestar::budget

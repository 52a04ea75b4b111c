// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/budget/cost_model.hpp>
#include <lodestar/budget/levers.hpp>

namespace lodestar::budget {

struct YangSettings {
    double targetMs = 16.6;
    double k = 0;          ///< calibrated cost of the coarse terms at r = 1 [ms]
    double maxStep = 0.2;  ///< largest |Δr| from one frame to the next
    double maxRate = 16;   ///< r never grows past this
};

/// The frame-rate controller of Yang et al. 2008, §3: Δt = K·Δ(1/r²), |Δr| ≤ 0.2, r ≥ 1.
class YangController {
public:
    explicit YangController(const YangSettings&, double startRate = 1);

    /// The levers of the next frame, given what the last one (rendered with the levers returned
    /// before) cost.
    Levers next(const FrameCosts& measured);

    double rate() const;
    /// True when r is at its limit and the frame still misses the target: shading is not what costs.
    bool saturated() const;
};

}  // namespace lodestar::budget

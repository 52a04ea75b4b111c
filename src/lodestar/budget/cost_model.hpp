// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lodestar::budget {

/// t = K/r² + C (Yang, Sander, Lawrence 2008, eq. 3): K is what the coarse terms cost at full
/// resolution, C everything else [ms].
struct CostModel {
    double k = 0;
    double c = 0;

    double frameMs(double r) const { return k / (r * r) + c; }
    /// The r ≥ 1 whose frame takes `targetMs`; +infinity when even C alone takes longer.
    double rateFor(double targetMs) const;
};

/// The model through two measured frames at different r. Throws std::invalid_argument when
/// rA == rB. K and C are clamped to ≥ 0.
CostModel fitCostModel(double rA, double msA, double rB, double msB);

}  // namespace lodestar::budget

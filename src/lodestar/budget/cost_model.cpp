// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/cost_model.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lodestar::budget {

double CostModel::rateFor(double targetMs) const {
    if (frameMs(1) <= targetMs) return 1;
    if (targetMs <= c) return std::numeric_limits<double>::infinity();
    return std::max(1.0, std::sqrt(k / (targetMs - c)));
}

CostModel fitCostModel(double rA, double msA, double rB, double msB) {
    if (!(rA >= 1) || !(rB >= 1) || !std::isfinite(rA) || !std::isfinite(rB))
        throw std::invalid_argument("fitCostModel: rates must be finite and at least 1");
    if (rA == rB) throw std::invalid_argument("fitCostModel: the two frames need different rates");
    if (!(msA >= 0) || !(msB >= 0) || !std::isfinite(msA) || !std::isfinite(msB))
        throw std::invalid_argument("fitCostModel: frame times must be finite and not negative");

    const double xA = 1 / (rA * rA), xB = 1 / (rB * rB);
    const double k = (msA - msB) / (xA - xB);
    // Noise can make the coarser frame the slower one: the terms then cost too little to measure,
    // and the better guess is that both frames are all C. A C below 0 means that K explains it all.
    if (k <= 0) return {0, (msA + msB) / 2};
    const double c = msA - k * xA;
    if (c < 0) return {(msA + msB) / (xA + xB), 0};
    return {k, c};
}

}  // namespace lodestar::budget

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/machine_speed.hpp>

#include <algorithm>
#include <vector>

#include <lodestar/budget/trace.hpp>

namespace lodestar::budget {
namespace {

struct Ratio {
    double slower;  ///< this frame's time / the time of the pass before
    double ms;
};

/// The ratio that passes which make up `share` of their time do not exceed; 1 of no passes.
double quantile(std::vector<Ratio>& ratios, double share) {
    double all = 0, passed = 0;
    for (const Ratio& ratio : ratios) all += ratio.ms;
    std::sort(ratios.begin(), ratios.end(),
              [](const Ratio& a, const Ratio& b) { return a.slower < b.slower; });
    for (const Ratio& ratio : ratios)
        if (passed += ratio.ms; passed >= share * all) return ratio.slower;
    return 1;
}

}  // namespace

double MachineSpeed::slowdown(const FrameCosts& measured) {
    std::vector<Ratio> overMedian, overLast;
    for (const PassCost& pass : measured.passes) {
        std::vector<double> before;
        for (const auto& frame : lately)
            for (const PassCost& one : frame)
                if (one.name == pass.name && one.ms > 0) before.push_back(one.ms);
        if (before.size() < kEnough || !(pass.ms > 0)) continue;
        overLast.push_back({pass.ms / before.back(), pass.ms});
        overMedian.push_back({pass.ms / median(std::move(before)), pass.ms});
    }
    lately.push_back(measured.passes);
    if (lately.size() > kSpan) lately.pop_front();

    const double slower = quantile(overMedian, kExempt);
    const bool leapt = quantile(overLast, kExempt) >= kLeap;
    const bool fell = quantile(overLast, 1 - kExempt) <= 1 / kLeap;
    const bool goesOn = burst > 0 && burst < kLongest && !fell;
    burst = slower >= kNoise && (leapt || goesOn) ? burst + 1 : 0;
    const bool whole = burst > 0 || slower < kNoise;
    return std::max(1.0, whole ? slower : std::min(slower, quantile(overLast, kExempt)));
}

}  // namespace lodestar::budget

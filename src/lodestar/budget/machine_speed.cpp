// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/machine_speed.hpp>

#include <algorithm>
#include <vector>

#include <lodestar/budget/trace.hpp>

namespace lodestar::budget {

double MachineSpeed::slowdown(const FrameCosts& measured) {
    struct Ratio {
        double slower;  ///< this frame's time / the median of the pass
        double ms;
    };
    std::vector<Ratio> ratios;
    double all = 0;
    for (const PassCost& pass : measured.passes) {
        std::vector<double> before;
        for (const auto& frame : lately)
            for (const PassCost& one : frame)
                if (one.name == pass.name && one.ms > 0) before.push_back(one.ms);
        if (before.size() < kEnough || !(pass.ms > 0)) continue;
        ratios.push_back({pass.ms / median(std::move(before)), pass.ms});
        all += pass.ms;
    }
    lately.push_back(measured.passes);
    if (lately.size() > kSpan) lately.pop_front();

    std::sort(ratios.begin(), ratios.end(),
              [](const Ratio& a, const Ratio& b) { return a.slower < b.slower; });
    double exempt = 0;
    for (const Ratio& ratio : ratios)
        if (exempt += ratio.ms; exempt >= kExempt * all) return std::max(1.0, ratio.slower);
    return 1;
}

}  // namespace lodestar::budget

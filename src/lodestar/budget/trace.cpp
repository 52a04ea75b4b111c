// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/trace.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lodestar::budget {

namespace {

constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

bool within(const TraceFrame& frame, double tolerance) {
    return std::abs(frame.ms - frame.targetMs) <= tolerance * frame.targetMs;
}

}  // namespace

double median(std::vector<double> values) {
    if (values.empty()) return kNoFigure;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

void Trace::add(const TraceFrame& frame) {
    if (!std::isfinite(frame.rate) || !std::isfinite(frame.ms) || !std::isfinite(frame.targetMs) ||
        frame.rate < 1 || frame.ms < 0 || frame.targetMs <= 0)
        throw std::invalid_argument("Trace::add: needs rate ≥ 1, ms ≥ 0 and targetMs > 0");
    run.push_back(frame);
}

double Trace::shareWithin(double tolerance, std::size_t settling) const {
    if (run.size() <= settling) return kNoFigure;
    const auto hits =
        std::count_if(run.begin() + std::ptrdiff_t(settling), run.end(),
                      [&](const TraceFrame& frame) { return within(frame, tolerance); });
    return double(hits) / double(run.size() - settling);
}

std::optional<std::size_t> Trace::settlingFrames(double tolerance) const {
    constexpr std::size_t kSpan = 10;
    constexpr std::ptrdiff_t kEnough = 9;
    for (std::size_t first = 0; first + kSpan <= run.size(); ++first) {
        const auto begin = run.begin() + std::ptrdiff_t(first);
        if (!within(*begin, tolerance)) continue;
        if (std::count_if(begin, begin + kSpan, [&](const TraceFrame& frame) {
                return within(frame, tolerance);
            }) >= kEnough)
            return first;
    }
    return std::nullopt;
}

double Trace::overshoot() const {
    std::vector<double> ratio;
    for (std::size_t i = 1; i + 1 < run.size(); ++i)
        ratio.push_back(median({run[i - 1].ms / run[i - 1].targetMs, run[i].ms / run[i].targetMs,
                                run[i + 1].ms / run[i + 1].targetMs}));
    const auto reached = std::find_if(ratio.begin(), ratio.end(),
                                      [](double value) { return std::abs(value - 1) <= 0.1; });
    if (reached == ratio.end()) return 0;
    // Coming from a frame that was too short, "past the target" is above it; coming from one that
    // was too long it is below.
    const bool fromBelow = run.front().ms < run.front().targetMs;
    double worst = 0;
    for (auto value = reached; value != ratio.end(); ++value)
        worst = std::max(worst, fromBelow ? *value - 1 : 1 - *value);
    return worst;
}

double Trace::turnShare(std::size_t settling, double epsilon) const {
    if (run.size() <= settling) return kNoFigure;
    std::size_t turns = 0;
    int heading = 0;                      // +1 growing, −1 shrinking, 0 not yet known
    double extreme = run[settling].rate;  // the furthest r got in this heading
    for (std::size_t i = settling + 1; i < run.size(); ++i) {
        const double change = run[i].rate - extreme;
        const int direction = change > 0 ? 1 : -1;
        if (heading == direction) {
            extreme = run[i].rate;
        } else if (std::abs(change) >= epsilon) {
            turns += heading != 0;
            heading = direction;
            extreme = run[i].rate;
        }
    }
    return double(turns) / double(run.size() - settling);
}

double Trace::medianMs(std::size_t settling) const {
    std::vector<double> values;
    for (std::size_t i = settling; i < run.size(); ++i) values.push_back(run[i].ms);
    return median(std::move(values));
}

double Trace::medianRate(std::size_t settling) const {
    std::vector<double> values;
    for (std::size_t i = settling; i < run.size(); ++i) values.push_back(run[i].rate);
    return median(std::move(values));
}

}  // namespace lodestar::budget

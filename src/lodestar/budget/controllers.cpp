// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/controllers.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <lodestar/budget/trace.hpp>

namespace lodestar::budget {

namespace {

// Chosen by simulation over 60 seeds of each load in tests/budget_test.cpp: a longer history is
// calmer on a steady load and late on a moving one. [targets] = fractions of the target.
constexpr std::size_t kHistory = 8;
constexpr std::size_t kRecent = 3;       // this many frames in a row are a new load, not a spike
constexpr double kNewLoad = 0.08;        // … when each is this far from the older ones [targets]
constexpr double kMargin = 0.025;        // aims this far under the target [targets]
constexpr double kDeadband = 0.025;      // r rests while the expected time is this close [targets]
constexpr double kGain = 0.3;            // share of a surprise that goes into K
constexpr double kSurpriseLimit = 0.15;  // a surprise counts for no more than this [targets]
constexpr double kSignal = 0.08;         // a change of r that moves t by this is clear [targets]
// On a machine noisier than about 5 % both limits widen with the noise [standard deviations].
constexpr double kNewLoadDeviations = 1.5;
constexpr double kDeadbandDeviations = 0.5;
constexpr double kNoiseMemory = 0.05;        // weight of the newest frame in the noise estimate
constexpr double kMeanToDeviation = 1.2533;  // √(π/2): of a normal distribution's mean |deviation|

void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("YangController: ") + what);
}

}  // namespace

YangController::YangController(const YangSettings& given, double startRate)
    : settings(given), r(startRate) {
    require(std::isfinite(given.targetMs) && given.targetMs > 0, "targetMs must be above 0");
    require(std::isfinite(given.k) && given.k >= 0, "k must not be negative");
    require(std::isfinite(given.maxStep) && given.maxStep > 0, "maxStep must be above 0");
    require(std::isfinite(given.maxRate) && given.maxRate >= 1, "maxRate must be at least 1");
    require(startRate >= 1 && startRate <= given.maxRate, "startRate must be in 1 … maxRate");
    estimate.k = std::max(given.k, 0.1 * given.targetMs);
    kFloor = estimate.k / 4;
    kCeiling = std::max(4 * estimate.k, 2 * given.targetMs);
}

Levers YangController::next(const FrameCosts& measured) {
    require(std::isfinite(measured.gpuMs) && measured.gpuMs >= 0, "gpuMs must be a time");
    const Sample newest{1 / (r * r), measured.gpuMs / machine.slowdown(measured)};
    learn(newest);
    history.push_back(newest);
    if (history.size() > kHistory) history.pop_front();
    forgetOldLoad();
    estimate.c = medianC();

    const double error = estimate.frameMs(r) - (1 - kMargin) * settings.targetMs;
    if (std::abs(error) > deadband()) {
        // The paper's law solved for the new r: K (1/r'² − 1/r²) = target − t.
        const double x = newest.x - error / estimate.k;
        const double limit = 1 / (settings.maxRate * settings.maxRate);
        const double wanted = x <= limit ? settings.maxRate : std::max(1.0, 1 / std::sqrt(x));
        r = std::clamp(wanted, r - settings.maxStep, r + settings.maxStep);
    }
    return Levers{.shadingRate = float(r)};
}

/// Takes from the frame's surprise how noisy the machine is, and the part that its change of r can
/// explain: a normalised least-mean-squares step of K. The median C it is compared with knows
/// nothing of this frame's own noise, so r following C does not pass for an effect of r.
void YangController::learn(Sample newest) {
    if (history.size() < kRecent) return;
    std::vector<double> xs;
    for (const Sample& sample : history) xs.push_back(sample.x);
    const double dx = newest.x - median(std::move(xs));
    const double limit = kSurpriseLimit * settings.targetMs;
    const double surprise =
        std::clamp(newest.ms - estimate.k * newest.x - medianC(), -limit, limit);
    noiseMs += kNoiseMemory * (kMeanToDeviation * std::abs(surprise) - noiseMs);

    const double clear = kSignal * settings.targetMs / estimate.k;
    estimate.k += kGain * dx * surprise / (dx * dx + clear * clear);
    estimate.k = std::clamp(estimate.k, kFloor, kCeiling);
}

/// Drops all but the newest frames when each of these lies clear of the older ones, on one side.
void YangController::forgetOldLoad() {
    if (history.size() <= kRecent) return;
    std::vector<double> older;
    const auto firstRecent = history.end() - kRecent;
    for (auto sample = history.begin(); sample != firstRecent; ++sample)
        older.push_back(sample->ms - estimate.k * sample->x);
    const double middle = median(std::move(older));
    const double clear = std::max(kNewLoad * settings.targetMs, kNewLoadDeviations * noiseMs);
    const auto lies = [&](double side) {
        return std::all_of(firstRecent, history.end(), [&](const Sample& sample) {
            return side * (sample.ms - estimate.k * sample.x - middle) > clear;
        });
    };
    if (lies(1) || lies(-1)) history.erase(history.begin(), firstRecent);
}

double YangController::medianC() const {
    std::vector<double> values;
    for (const Sample& sample : history) values.push_back(sample.ms - estimate.k * sample.x);
    return median(std::move(values));
}

double YangController::deadband() const {
    return std::max(kDeadband * settings.targetMs, kDeadbandDeviations * noiseMs);
}

bool YangController::saturated() const {
    return r >= settings.maxRate && estimate.frameMs(r) > settings.targetMs + deadband();
}

}  // namespace lodestar::budget

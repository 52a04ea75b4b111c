// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/proportional_controller.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lodestar::budget {
namespace {

constexpr double kBandStep = 0.25;  // share of a band's width that S moves in a frame
/// How far past a band's end the law must ask before the band changes [widths].
constexpr double kBandHold = 0.25;

/// Steps of the light maps' scale, and how far S must be from the present one to leave it.
constexpr double kShadowStep = 0.125, kShadowHold = 0.1;
constexpr float kLeastShare = 0.25f;  // of layerScale and shadowScale

void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("ProportionalController: ") + what);
}

}  // namespace

ProportionalController::ProportionalController(const ProportionalSettings& given, double startScale)
    : settings(given), s(startScale), wanted(startScale), band(startScale), shadow(1) {
    require(std::isfinite(given.targetMs) && given.targetMs > 0, "targetMs must be above 0");
    require(given.k > 0 && given.k < 1, "k must be between 0 and 1");
    require(std::isfinite(given.most) && given.least > 0 && given.most >= given.least,
            "least must be above 0 and at most `most`");
    require(std::isfinite(given.spike) && given.spike >= 1, "spike must be at least 1");
    require(std::isfinite(given.hysteresis) && given.hysteresis >= 0,
            "hysteresis must not be negative");
    require(given.bands >= 0, "bands must not be negative");
    require(startScale >= given.least && startScale <= given.most,
            "startScale must be in least … most");
    require(given.controls.any(), "controls must name something");
    holdShadow();
}

void ProportionalController::update(const FrameCosts& measured) {
    const auto isTime = [](double ms) { return std::isfinite(ms) && ms >= 0; };
    require(isTime(measured.gpuMs), "gpuMs must be a time");
    require(isTime(measured.intervalMs), "intervalMs must be a time");
    const bool stalled = measured.intervalMs > settings.spike * measured.gpuMs;
    double t = measured.gpuMs;
    if (measured.intervalMs > 0 && !stalled) t = (measured.gpuMs + measured.intervalMs) / 2;
    missing = t > settings.targetMs * (1 + settings.hysteresis);

    // With bands the frame was not rendered at what the law wants: its time is taken to what that
    // would have cost, as pixels go.
    if (settings.bands > 0) t *= wanted * wanted / (s * s);
    const double error = (settings.targetMs - t) / settings.targetMs;
    if (std::abs(error) > settings.hysteresis)
        wanted = std::clamp(wanted + settings.k * wanted * error, settings.least, settings.most);

    if (settings.bands > 0) {
        band = bandOf(wanted);
        const double step = kBandStep * (settings.most - settings.least) / settings.bands;
        s += std::clamp(band - s, -step, step);
    } else {
        s = wanted;
    }
    holdShadow();
}

void ProportionalController::holdShadow() {
    const double share = std::min(s, 1.0);
    if (std::abs(share - shadow) > kShadowHold)
        shadow = std::round(share / kShadowStep) * kShadowStep;
}

Levers ProportionalController::drive(const Levers& given) const {
    Levers levers = given;
    const auto share = [](float most, double of) {
        return std::clamp(most * static_cast<float>(of), std::min(kLeastShare, most), most);
    };
    const ScaleControls& controls = settings.controls;
    if (controls.render)
        levers.renderScale = AxisScale(static_cast<float>(s)).atMost(given.renderScale.atLeast(1));
    if (controls.layer) levers.layerScale = share(given.layerScale, std::min(s, 1.0));
    if (controls.shadow) levers.shadowScale = share(given.shadowScale, shadow);
    return levers;
}

/// Bands start at least and the highest is most. The band below what is wanted, so that the target
/// is met; the present one while that is not clearly left.
double ProportionalController::bandOf(double scale) const {
    const double width = (settings.most - settings.least) / settings.bands;
    if (width == 0) return settings.most;
    const bool inside = scale > band - kBandHold * width && scale < band + (1 + kBandHold) * width;
    const double below = settings.least + std::floor((scale - settings.least) / width) * width;
    const bool onBand = std::abs((band - settings.least) / width -
                                 std::round((band - settings.least) / width)) < 1e-6;
    if (scale >= settings.most) return settings.most;
    return inside && onBand ? band : below;
}

}  // namespace lodestar::budget

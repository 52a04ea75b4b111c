// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <lodestar/budget/controllers.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/paper_scenes.hpp"
#include "app/bench/published.hpp"
#include "app/budget_run.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/judge.hpp"
#include "app/whole_file.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kTaps = 15;  // the load at rest: heavy enough that r has something to give
constexpr float kTurn = 1.2f;        // of the view, radians
constexpr float kNear = 0.4f;        // of the way to the car

/// What disturbs the run: each a quarter of it, and the last all at once.
constexpr std::array kDisturbances{"view", "coverage", "load", "all"};

struct Moment {
    scene::Camera camera;
    std::uint32_t taps = kTaps;
    std::size_t disturbance = 0;
    bool step = false;  ///< the load jumps here
};

/// N of the N×N taps: up, down and back, in steps.
std::uint32_t tapsAt(double part) {
    return part < 0.25 ? kTaps : part < 0.5 ? kTaps + 5 : part < 0.75 ? kTaps - 5 : kTaps;
}

/// Frame `index` of `count`: in each quarter the disturbance comes and goes.
Moment momentAt(const scene::Camera& start, std::size_t index, std::size_t count) {
    const double all = 4.0 * static_cast<double>(index) / static_cast<double>(count);
    const auto quarter = std::min<std::size_t>(static_cast<std::size_t>(all), 3);
    const double part = all - static_cast<double>(quarter);
    const auto wave = static_cast<float>(std::sin(std::numbers::pi * part));
    Moment moment{.camera = start, .disturbance = quarter};
    if (quarter == 0 || quarter == 3)
        moment.camera = scene::orbited(moment.camera, moment.camera.at, kTurn * wave);
    if (quarter == 1 || quarter == 3) moment.camera = scene::dollied(moment.camera, kNear * wave);
    if (quarter == 2 || quarter == 3) moment.taps = tapsAt(part);
    if (index > 0) {
        const Moment before = momentAt(start, index - 1, count);
        moment.step = before.taps != moment.taps;
    }
    return moment;
}

/// Frames after a jump of the load until the time is held again, the median over the jumps; none
/// where it never is.
std::optional<double> settlingAfterSteps(const budget::Trace& trace,
                                         const std::vector<std::size_t>& steps) {
    std::vector<double> frames;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const std::size_t end = i + 1 < steps.size() ? steps[i + 1] : trace.frames().size();
        budget::Trace part;
        for (std::size_t f = steps[i]; f < end; ++f) part.add(trace.frames()[f]);
        const auto settled = part.settlingFrames();
        if (!settled) return std::nullopt;
        frames.push_back(static_cast<double>(*settled));
    }
    if (frames.empty()) return std::nullopt;
    return budget::median(frames);
}

Json rowOf(const BenchCase& what, const BenchOptions& options, const char* method,
           const char* disturbance, const budget::Trace& trace,
           const std::vector<std::size_t>& steps, std::size_t settling, double fullMs) {
    const auto settled = settlingAfterSteps(trace, steps);
    return {{"measures", "framerate-control"},
            {"scene", fs::path(what.scene).filename().string()},
            {"width", options.view.size.width},
            {"height", options.view.size.height},
            {"method", method},
            {"disturbance", disturbance},
            {"frames", trace.frames().size()},
            {"full_ms", fullMs},
            {"target_ms", trace.frames().front().targetMs},
            {"achieved_ms", trace.medianMs(settling)},
            {"median_r", trace.medianRate(settling)},
            {"within_5_share", trace.shareWithin(0.05, settling)},
            {"within_10_share", trace.shareWithin(0.1, settling)},
            {"overshoot_share", trace.overshoot()},
            {"turn_share", trace.turnShare(settling)},
            {"settling_frames", settled ? Json(*settled) : Json()}};
}

/// A whole run, and each disturbance of it.
struct Recorded {
    budget::Trace whole;
    std::array<budget::Trace, kDisturbances.size()> parts;

    void add(std::size_t disturbance, const budget::TraceFrame& frame) {
        whole.add(frame);
        parts[disturbance].add(frame);
    }
};

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = benchCases(options, {{kPaperScenes[0].file, kPaperScenes[0].camera, ""}});
    if (!cases) return tl::unexpected(cases.error());
    const BenchCase& what = cases->front();
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    frame::FrameSettings settings = options.settings;
    settings.shadowTaps = kTaps;
    frame::Frame frame(*session.device, *session.gpuScene, settings);

    const Calibration calibration = calibrate(frame, camera, {}, std::min(options.rounds, 5));
    const double targetMs = options.budget.targetMs(calibration.fullMs);
    const double startRate = std::clamp(calibration.model.rateFor(targetMs), 1.0, 8.0);
    budget::YangController controller({.targetMs = targetMs, .k = calibration.model.k}, startRate);
    budget::Levers levers{.shadingRate = static_cast<float>(startRate)};
    const budget::Levers fixed = levers;
    Recorded controlled, uncontrolled;
    std::vector<std::size_t> steps;
    Json trace = Json::array();
    std::vector<budget::FrameCosts> costs;
    Progress bar("rendering", options.frames);
    for (std::size_t i = 0; i < options.frames; ++i) {
        const Moment moment = momentAt(camera, i, options.frames);
        if (moment.step) steps.push_back(i);
        frame.setShadowTaps(moment.taps);
        // In turn, so that what else the machine does falls on both.
        const double without = frame.render(moment.camera, fixed).gpuMs;
        costs.push_back(costsOf(frame.render(moment.camera, levers)));
        controlled.add(moment.disturbance, {levers.shadingRate, costs.back().gpuMs, targetMs});
        uncontrolled.add(moment.disturbance, {fixed.shadingRate, without, targetMs});
        trace.push_back({{"frame", i},
                         {"disturbance", kDisturbances[moment.disturbance]},
                         {"taps", moment.taps},
                         {"target_ms", targetMs},
                         {"r", levers.shadingRate},
                         {"frame_ms", costs.back().gpuMs},
                         {"uncontrolled_r", fixed.shadingRate},
                         {"uncontrolled_ms", without}});
        levers.shadingRate = controller.next(costs.back()).shadingRate;
        bar.update(i + 1);
    }
    bar.erase();

    BenchResult result;
    describeDevice(session, result.report);
    result.report.settings = settingsJson(settings);
    result.report.settings["frames"] = options.frames;
    result.report.passes = summarisePasses(costs);
    result.report.frameMs = controlled.whole.medianMs();
    result.report.counts = countsOf(session, frame);
    for (const auto& [name, run] :
         {std::pair{"with control", &controlled}, std::pair{"without", &uncontrolled}}) {
        result.rows.push_back(rowOf(what, options, name, "whole run", run->whole, steps,
                                    budget::Trace::kSettling, calibration.fullMs));
        for (std::size_t d = 0; d < kDisturbances.size(); ++d)
            if (!run->parts[d].frames().empty())
                result.rows.push_back(rowOf(what, options, name, kDisturbances[d], run->parts[d],
                                            {}, 0, calibration.fullMs));
    }
    result.files.push_back(options.out / "framerate-control.trace.csv");
    if (auto done = writeWholeFile(result.files.back(), csvOf(trace)); !done)
        return tl::unexpected(done.error());
    const Json& limits = published("yang2008_section3");
    result.source = Json::array({{{"source", limits.at("source")},
                                  {"method", "yang"},
                                  {"largest_step_r", limits.at("largest_step_r")},
                                  {"least_r", limits.at("least_r")}}});
    if (auto verdict = validationVerdict(*session.device); !verdict)
        return tl::unexpected(verdict.error());
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    const auto within = [&](const char* method) {
        for (const Json& row : rows)
            if (row.at("method") == method && row.at("disturbance") == "whole run")
                return 100 * row.at("within_10_share").get<double>();
        return 0.0;
    };
    // The paper shows curves; what they claim is that control holds what is not held without.
    const double more = within("with control") - within("without");
    return {{"frames within 10 %, with control beyond without", more, "points", "> 0", more > 0}};
}

}  // namespace

Bench framerateControlBench() {
    return {.name = "framerate-control",
            .what =
                "the paper's Figure 5: the car while view, coverage and load change, with and "
                "without control",
            .run = run,
            .bars = barsOf,
            .tables = {{"framerate-control",
                        {"method", "disturbance", "frames", "target_ms", "achieved_ms", "median_r",
                         "within_5_share", "within_10_share", "overshoot_share", "turn_share",
                         "settling_frames"}}}};
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/bench/benches.hpp"
#include "app/bench/published.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"
#include "app/whole_file.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kSamples = 8;  // frames of a run that are judged against full quality

/// Where the run starts: half of a partial orbit before the view asked for, so that it passes that
/// view in the middle and strays least from it (an interior has walls).
scene::Camera startOf(const scene::Camera& camera, const CameraPath& path) {
    const bool partial = path.kind == CameraPath::Kind::orbit && std::abs(path.amount) < 6.28f;
    return partial ? scene::orbited(camera, camera.at, -path.amount / 2) : camera;
}

/// Median and worst over the sampled frames. The last sample and its full-quality picture are
/// written.
Result<void> judge(const Session& session, frame::Frame& frame, const Run& run,
                   const fs::path& stem, Json& row, std::vector<fs::path>& files) {
    const RunQuality quality = judgeRun(session, frame, run);
    row["quality_frames"] = quality.frames.size();
    row["psnr_db"] = finiteOrNull(quality.median.psnrDb);
    row["psnr_worst_db"] = finiteOrNull(quality.worstPsnrDb);
    row["ssim"] = finiteOrNull(quality.median.ssim);
    row["flip"] = quality.median.flip;
    const fs::path test = stem.string() + ".png", reference = stem.string() + ".reference.png";
    files.insert(files.end(), {test, reference});
    if (auto done = writePng(test, run.samples.back().picture); !done) return done;
    return writePng(reference, quality.lastReference);
}

/// What the machine allows: the share of frames within 10 % of their median when nothing changes
/// from one to the next. No governor holds more.
double steadyShare(frame::Frame& frame, const scene::Camera& camera, const budget::Levers& levers,
                   std::size_t frames) {
    std::vector<double> times;
    for (std::size_t i = 0; i < frames; ++i) times.push_back(frame.render(camera, levers).gpuMs);
    const double middle = budget::median(times);
    const auto near = std::count_if(times.begin(), times.end(), [&](double ms) {
        return std::abs(ms - middle) <= 0.1 * middle;
    });
    return static_cast<double>(near) / static_cast<double>(frames);
}

Json rowOf(const BenchCase& what, const BenchOptions& options, const Calibration& calibration,
           const Run& run, double targetMs) {
    const budget::Trace& trace = run.trace;
    const auto settled = trace.settlingFrames();
    return {{"measures", "budget"},
            {"scene", fs::path(what.scene).filename().string()},
            {"camera", what.camera},
            {"path", what.path},
            {"width", options.view.size.width},
            {"height", options.view.size.height},
            {"method", "yang"},
            {"frames", trace.frames().size()},
            {"settling_allowed", budget::Trace::kSettling},
            {"full_ms", calibration.fullMs},
            {"k_ms", calibration.model.k},
            {"c_ms", calibration.model.c},
            {"target_ms", targetMs},
            {"achieved_ms", trace.medianMs()},
            {"within_10_share", trace.shareWithin(0.1)},
            {"within_5_share", trace.shareWithin(0.05)},
            {"turn_share", trace.turnShare()},
            {"settled_after", settled ? Json(*settled) : Json()},
            {"overshoot_share", trace.overshoot()},
            {"median_r", trace.medianRate()},
            {"saturated", run.saturated}};
}

Result<void> measureScene(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const auto path = parsePath(what.path);
    if (!path) return tl::unexpected(path.error());
    const scene::Camera start = startOf(camera, *path);
    frame::Frame frame(*session.device, *session.gpuScene, options.settings);
    const Calibration calibration =
        calibrate(frame, path->at(start, 0, options.frames), {.repair = kRepair}, options.rounds);
    const double targetMs = options.budget.targetMs(calibration.fullMs);
    const RunOptions runOptions{.frames = options.frames,
                                .path = *path,
                                .levers = {.repair = kRepair},
                                .targetMs = targetMs,
                                .calibration = calibration,
                                .samples = std::min(kSamples, options.frames)};
    Result<void> outcome;
    const Run run = renderRun(
        session, frame, start, runOptions, [](std::size_t) { return Result<void>(); }, outcome);
    if (!outcome) return outcome;

    Json row = rowOf(what, options, calibration, run, targetMs);
    row["steady_within_10_share"] =
        steadyShare(frame, start,
                    {.shadingRate = static_cast<float>(run.trace.medianRate()), .repair = kRepair},
                    options.frames);
    const fs::path stem = options.out / ("budget-hold." + sceneSlug(what.scene));
    if (auto done = judge(session, frame, run, stem, row, result.files); !done) return done;
    const fs::path trace = stem.string() + ".trace.csv";
    result.files.push_back(trace);
    if (auto done = writeWholeFile(trace, csvOf(traceRows(run))); !done) return done;
    if (result.rows.empty()) {
        describeDevice(session, result.report);
        result.report.passes = summarisePasses(run.costs);
        result.report.frameMs = run.trace.medianMs();
        result.report.counts = countsOf(session, frame);
    }
    result.rows.push_back(row);
    return validationVerdict(*session.device);
}

Result<BenchResult> run(const BenchOptions& options) {
    auto cases = benchCases(options, {{"sponza.glb", "nave", "orbit:40"},
                                      {"chess_abeautifulgame.glb", "player", "orbit"},
                                      {"city_kaykit.glb", "street", "orbit:15"}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    result.report.settings["frames"] = options.frames;
    result.report.settings["budget"] = options.budget.kind == budget::Budget::Kind::relative
                                           ? Json(fmt::format("{:g}%", 100 * options.budget.value))
                                           : Json(fmt::format("{:g}ms", options.budget.value));
    for (BenchCase& one : *cases) {
        if (one.path.empty()) one.path = "orbit:40";
        if (auto done = measureScene(one, options, result); !done)
            return tl::unexpected(done.error());
    }
    // The paper shows Figure 5 as curves without numbers; these are the limits it states in §3.
    const Json& limits = published("yang2008_section3");
    result.source = Json::array({{{"source", limits.at("source")},
                                  {"method", "yang"},
                                  {"largest_step_r", limits.at("largest_step_r")},
                                  {"least_r", limits.at("least_r")}}});
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        const std::string scene = row.at("scene");
        const double within = 100 * row.at("within_10_share").get<double>();
        const double turns = 100 * row.at("turn_share").get<double>();
        bars.push_back(
            {"frames within 10 % of the budget: " + scene, within, "%", ">= 90", within >= 90});
        bars.push_back(
            {"frames at which r turns around: " + scene, turns, "%", "< 10", turns < 10});
    }
    return bars;
}

}  // namespace

Bench budgetHoldBench() {
    return {.name = "budget-hold",
            .what = "how well a budget is held while the camera moves, and the quality it leaves",
            .run = run,
            .bars = barsOf,
            .tables = {{"budget",
                        {"scene", "path", "full_ms", "target_ms", "achieved_ms", "within_10_share",
                         "steady_within_10_share", "within_5_share", "turn_share", "median_r",
                         "k_ms", "c_ms", "psnr_db", "ssim", "flip"}}}};
}

}  // namespace lodestar::app

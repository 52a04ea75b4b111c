// SPDX-License-Identifier: Apache-2.0
#include "app/render.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <lodestar/quality/metrics.hpp>

#include "app/aov.hpp"
#include "app/budget_run.hpp"
#include "app/capture.hpp"
#include "app/console.hpp"
#include "app/controller_options.hpp"
#include "app/frame_options.hpp"
#include "app/geometry_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"
#include "app/tune.hpp"
#include "app/whole_file.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

struct Options {
    std::string scene;
    gpu::DeviceRequest device;
    ViewOptions view;
    frame::FrameSettings settings;
    frame::CaptureSettings capture;
    fs::path out, json;
    std::size_t frames = 1;
    CameraPath path;
    double seconds = 0;
    double fps = 60;
    std::optional<budget::Budget> budget;
    ControllerOptions controller;
    budget::Levers levers;
    std::vector<std::string> aovs;
    fs::path settingsFile;  ///< of calibrate
    bool tuned = false;     ///< the levers are chosen in a warm-up
    bool reference = false;
    std::string outside;  ///< camera to look from at what the last frame drew; empty = none
};

/// `frame.png` with frame number 7 of a numbered run: `frame.0007.png`.
fs::path numbered(const fs::path& out, std::size_t index) {
    return fs::path(out).replace_extension(fmt::format("{:04}{}", index, out.extension().string()));
}

fs::path beside(const fs::path& out, const char* what) {
    return fs::path(out).replace_extension(std::string(what) + out.extension().string());
}

/// The last sample at full quality and its FLIP map, beside the picture.
Result<void> writeReference(const fs::path& out, const RunQuality& quality,
                            const quality::RgbImage& test, std::vector<fs::path>& files) {
    const quality::RgbImage& full = quality.lastReference;
    files.insert(files.end(), {beside(out, "reference"), beside(out, "flip")});
    if (auto written = writePng(beside(out, "reference"), full); !written) return written;
    return writePng(beside(out, "flip"), quality::falseColor(quality::flipMap(full, test)));
}

std::string percent(double share) {
    return fmt::format("{:.0f} %", 100 * share);
}

std::string db(double value) {
    return std::isinf(value) ? "identical" : fmt::format("{:.1f} dB", value);
}

void printPasses(const std::vector<PassTimes>& passes, double frameMs) {
    Table table({{"pass"},
                 {"median", Table::Align::right},
                 {"min", Table::Align::right},
                 {"max", Table::Align::right}});
    for (const PassTimes& pass : passes)
        table.row({pass.name, formatMs(pass.median), formatMs(pass.least), formatMs(pass.most)});
    table.row({"frame", formatMs(frameMs), "", ""});
    fmt::print("{}", table.text());
}

struct Outcome {
    Calibration calibration;
    std::optional<double> targetMs;
    budget::ScaleControls controls;  ///< as used
    Run run;
    double frameMs = 0;
    std::optional<RunQuality> quality;
};

void printSummary(const Options& options, const Outcome& outcome) {
    Table table({{""}, {""}, {""}});
    if (outcome.targetMs) {
        const budget::Trace& trace = outcome.run.trace;
        const std::size_t settling =
            options.frames > 2 * budget::Trace::kSettling ? budget::Trace::kSettling : 0;
        table.row({"full quality", formatMs(outcome.calibration.fullMs), "from the first camera"});
        table.row({"budget", formatMs(*outcome.targetMs),
                   percent(*outcome.targetMs / outcome.calibration.fullMs) + " of full quality"});
        table.row({"achieved", formatMs(trace.medianMs(settling)),
                   fmt::format("median of {} frames, {}", options.frames,
                               options.controller.scales()
                                   ? mediansOf(outcome.run, outcome.controls, settling)
                                   : fmt::format("r = {:.2f}", trace.medianRate(settling)))});
        table.row({"within 10 %", percent(trace.shareWithin(0.1, settling)),
                   fmt::format("of the frames after the first {}", settling)});
        table.row({"within 5 %", percent(trace.shareWithin(0.05, settling)), ""});
        table.row({options.controller.scales() ? "S turns around in" : "r turns around in",
                   percent(trace.turnShare(settling)), "of the frames"});
    } else {
        table.row(
            {"frame", formatMs(outcome.frameMs),
             fmt::format("median of {}, r = {:.2f}", options.frames, options.levers.shadingRate)});
    }
    if (outcome.quality) {
        const RunQuality& q = *outcome.quality;
        const std::string note = q.frames.size() == 1
                                     ? "against full quality"
                                     : fmt::format(
                                           "median of {} frames against full quality, "
                                           "worst {}",
                                           q.frames.size(), db(q.worstPsnrDb));
        table.row({"PSNR", db(q.median.psnrDb), note});
        table.row({"SSIM", fmt::format("{:.4f}", q.median.ssim), "1 = identical"});
        table.row({"FLIP", fmt::format("{:.4f}", q.median.flip), "0 = no visible difference"});
    }
    fmt::print("\n{}", table.text());
    if (outcome.run.saturated)
        fmt::print(
            "note: {} is at its limit and the budget is still missed: what costs here is not {}; "
            "raise the budget or lower --size\n",
            options.controller.scales() ? "S" : "r",
            options.controller.scales() ? "the pixels" : "the coarse shading");
}

Result<void> writeReport(const Options& options, const Session& session, const frame::Frame& frame,
                         const Json& counts, const std::vector<PassTimes>& passes,
                         const Outcome& outcome, const std::optional<Tuning>& tuning) {
    Report report;
    describeDevice(session, report);
    report.settings = settingsJson(frame.settings());
    report.settings.update(leversJson(options.levers));
    report.settings["frames"] = options.frames;
    report.passes = passes;
    report.frameMs = outcome.frameMs;
    if (tuning) report.more["auto"] = tuningJson(*tuning);
    report.counts = counts;
    if (outcome.quality) {
        report.quality = outcome.quality->median;
        Json frames = Json::array();
        for (std::size_t i = 0; i < outcome.quality->frames.size(); ++i) {
            const QualityFigures& q = outcome.quality->frames[i];
            frames.push_back({{"frame", outcome.run.samples[i].index},
                              {"psnr_db", std::isinf(q.psnrDb) ? Json() : Json(q.psnrDb)},
                              {"ssim", q.ssim},
                              {"flip_mean", q.flip}});
        }
        report.more["quality_frames"] = frames;
    }
    if (outcome.targetMs) {
        const budget::Trace& trace = outcome.run.trace;
        report.more["budget"] = {{"full_ms", outcome.calibration.fullMs},
                                 {"target_ms", *outcome.targetMs},
                                 {"achieved_ms", trace.medianMs()},
                                 {"within_10_percent", trace.shareWithin(0.1)},
                                 {"within_5_percent", trace.shareWithin(0.05)},
                                 {"turn_share", trace.turnShare()},
                                 {"k_ms", outcome.calibration.model.k},
                                 {"c_ms", outcome.calibration.model.c}};
        if (options.controller.scales())
            report.more["budget"]["controls"] = controlsJson(outcome.controls);
        Json frames = Json::array();
        for (const Json& row : traceRows(outcome.run))
            frames.push_back({{"r", row.at("r")},
                              {"s", row.at("s")},
                              {"s_x", row.at("s_x")},
                              {"s_y", row.at("s_y")},
                              {"layer_scale", row.at("layer_scale")},
                              {"shadow_scale", row.at("shadow_scale")},
                              {"ms", row.at("frame_ms")}});
        report.more["frames"] = frames;
    }
    return writeJson(options.json, toJson(report));
}

/// The levers that suit the run best, measured from its first camera, and half-way where it moves.
Result<Tuning> warmUp(const Options& options, const Session& session, frame::Frame& frame,
                      const scene::Camera& start) {
    std::vector<scene::Camera> cameras{options.path.at(start, 0, options.frames)};
    if (options.path.kind != CameraPath::Kind::still && options.frames > 1)
        cameras.push_back(options.path.at(start, options.frames / 2, options.frames));
    return tune(*session.device, frame, cameras,
                {.budget = *options.budget,
                 .repair = options.levers.repair,
                 .localRate = options.levers.localRate});
}

/// Several samples a pixel are shaded at full rate: what says otherwise is refused.
Result<void> checkCapture(const Options& options) {
    const std::uint32_t side = options.capture.side;
    if (side == 1 && options.capture.backend == frame::CaptureBackend::multisample)
        return fail("--capture ms: for several samples a pixel; give --capture-rate");
    if (side == 1) return {};
    const budget::Levers& levers = options.levers;
    bool full = true;
    for (std::size_t i = 0; i < budget::kTerms; ++i) full &= levers.rate(budget::Term(i)) == 1;
    if (options.budget || !options.settingsFile.empty() || !full || options.settings.showLods ||
        !options.outside.empty() || levers.renderScale != 1 || options.settings.supersample > 1 ||
        options.settings.temporal.mode != scale::TemporalMode::off ||
        options.settings.post.shutter > 0)
        return fail(
            "--capture-rate over 1 shades the finest level of detail at full rate: leave out "
            "--budget, --settings, --shading-rate, --show-lods, --outside, --scale, --supersample, "
            "--temporal and --motion-blur");
    if (std::max(options.view.size.width, options.view.size.height) > int(16384 / side))
        return fail(fmt::format("--size: at {} samples a pixel at most {} a side", side * side,
                                16384 / side));
    return {};
}

/// What effects do not go together with.
Result<void> checkEffects(const Options& options) {
    if (!options.settings.post.any()) return {};
    if (options.levers.resizeAll)
        return fail("--full-resize shades no picture of full size: leave it or the effects out");
    if (options.settings.post.downsampled && options.settings.supersample > 1)
        return fail("--post-inputs downsampled: not with --supersample");
    return {};
}

Result<void> run(Options options) {
    if (auto can = checkCapture(options); !can) return can;
    if (auto can = checkController(options.controller, options.budget.has_value()); !can)
        return can;
    if (auto can = checkEffects(options); !can) return can;
    if (!options.settingsFile.empty()) {
        const auto levers = readSettings(options.settingsFile);
        if (!levers) return tl::unexpected(levers.error());
        const auto effects = options.levers.postRates;  // of which the file says nothing
        options.levers = *levers;
        options.levers.postRates = effects;
    }
    options.settings.captureSide = options.capture.side;
    options.settings.capture = options.capture.backend;
    auto session = openSession(options.scene, options.device);
    if (!session) return tl::unexpected(session.error());
    const auto camera = resolveCamera(*session, options.view);
    if (!camera) return tl::unexpected(camera.error());
    if (session->gpuScene->animated())
        session->gpuScene->animate(static_cast<float>(options.seconds));
    options.settings.size = vk::Extent2D{static_cast<std::uint32_t>(options.view.size.width),
                                         static_cast<std::uint32_t>(options.view.size.height)};
    options.settings.maxScale = options.levers.renderScale.atLeast(1);
    keepForAovs(options.aovs, options.settings);
    frame::Frame frame(*session->device, *session->gpuScene, options.settings);
    fmt::print("{} at {}x{} on {}\n", printable(options.scene), options.view.size.width,
               options.view.size.height, session->device->description().name);

    std::optional<Tuning> tuning;
    if (options.tuned) {
        auto done = warmUp(options, *session, frame, *camera);
        if (!done) return tl::unexpected(done.error());
        tuning = std::move(*done);
        printTuning(*tuning);
        const auto effects = options.levers.postRates;
        options.levers = tuning->levers;
        options.levers.postRates = effects;
    }
    RunOptions runOptions{
        .frames = options.frames,
        .path = options.path,
        .startSeconds = options.seconds,
        .fps = options.fps,
        .levers = options.levers,
        .samples = options.reference ? std::min<std::size_t>(options.frames, 12) : 0};
    Outcome outcome;
    if (options.budget) {
        if (options.controller.scales()) {
            const auto settings =
                proportionalSettings(options.controller, *session, options.settings);
            if (!settings) return tl::unexpected(settings.error());
            runOptions.proportional = *settings;
            outcome.controls = settings->controls;
        }
        outcome.calibration =
            calibrate(frame, options.path.at(*camera, 0, options.frames), options.levers, 5);
        runOptions.calibration = outcome.calibration;
        outcome.targetMs = options.budget->targetMs(outcome.calibration.fullMs);
        if (options.controller.kind != "none") runOptions.targetMs = outcome.targetMs;
    }

    std::vector<fs::path> files;
    const bool numberFrames = options.out.string().find('#') != std::string::npos;
    fs::path out = options.out;
    if (numberFrames) {
        std::string name = options.out.string();
        std::erase(name, '#');
        out = name;
        if (fs::path stem = out.stem(); stem.empty()) out = out.parent_path() / "frame.png";
        options.out = out;
    }
    Json counts;
    Result<void> written;
    outcome.run = renderRun(
        *session, frame, *camera, runOptions,
        [&](std::size_t i) -> Result<void> {
            const bool last = i + 1 == options.frames;
            if (last) counts = countsOf(*session, frame);
            if (!numberFrames && !last) return {};
            const fs::path file = numberFrames ? numbered(out, i) : out;
            if (last || files.empty()) files.push_back(file);
            if (auto done = writePng(file, readDisplay(*session->device, frame)); !done)
                return done;
            if (!last || options.aovs.empty()) return {};
            auto aovs = writeAovs(*session->device, frame, options.aovs, out);
            if (!aovs) return tl::unexpected(aovs.error());
            files.insert(files.end(), aovs->begin(), aovs->end());
            return {};
        },
        written);
    if (!written) return written;
    std::vector<double> frameTimes;
    for (const auto& costs : outcome.run.costs) frameTimes.push_back(costs.gpuMs);
    outcome.frameMs = budget::median(frameTimes);
    if (options.reference) {
        // Full quality is a picture of its own, without what came before it.
        frame::FrameSettings alone = frame.settings();
        std::optional<frame::Frame> plain;
        if (alone.temporal.mode != scale::TemporalMode::off) {
            alone.temporal.mode = scale::TemporalMode::off;
            plain.emplace(*session->device, *session->gpuScene, alone);
        }
        outcome.quality = judgeRun(*session, plain ? *plain : frame, outcome.run);
        const auto written = writeReference(options.out, *outcome.quality,
                                            outcome.run.samples.back().picture, files);
        if (!written) return written;
    }

    if (!options.outside.empty()) {
        ViewOptions view{.size = options.view.size, .camera = options.outside};
        const auto outside = resolveCamera(*session, view);
        if (!outside) return tl::unexpected(outside.error());
        // Judging renders other frames: draw the last one once more.
        frame.render(outcome.run.lastCamera, options.levers);
        frame.renderOutside(*outside);
        files.push_back(beside(out, "outside"));
        if (auto done = writePng(files.back(), readDisplay(*session->device, frame)); !done)
            return done;
    }

    const auto passes = summarisePasses(outcome.run.costs);
    printPasses(passes, outcome.frameMs);
    printSummary(options, outcome);
    if (!options.controller.trace.empty()) {
        files.push_back(options.controller.trace);
        if (auto done = writeWholeFile(files.back(), csvOf(traceRows(outcome.run))); !done)
            return done;
    }
    if (!options.json.empty()) {
        if (auto done = writeReport(options, *session, frame, counts, passes, outcome, tuning);
            !done)
            return done;
        files.push_back(options.json);
    }
    for (const fs::path& file : files) fmt::print("wrote {}\n", file.string());
    return validationVerdict(*session->device);
}

}  // namespace

void addRender(CLI::App& app, int& exitCode) {
    auto o = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "render",
        "render one frame or a run of frames, at a fixed shading rate or inside a budget");
    addSceneArgument(*command, o->scene);
    command
        ->add_option("--out", o->out,
                     "the picture, a PNG; of a run the last frame, or all of them when the name "
                     "holds a # for the number")
        ->type_name("FILE")
        ->required();
    addViewOptions(*command, o->view);
    command->add_option("--frames", o->frames, "frames to render")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str()
        ->group("Run");
    addParsed(*command, "--path", o->path, parsePath,
              "camera path: orbit[:DEGREES], dolly[:FRACTION] or a JSON file of cameras")
        ->type_name("PATH")
        ->group("Run");
    command
        ->add_option("--time", o->seconds, "when in the animation the first frame is, in seconds")
        ->type_name("S")
        ->check(CLI::NonNegativeNumber)
        ->group("Run");
    command->add_option("--fps", o->fps, "frames a second of animation time")
        ->check(CLI::PositiveNumber)
        ->capture_default_str()
        ->group("Run");
    CLI::Option* budget =
        addParsed(
            *command, "--budget", o->budget,
            [](const std::string& text) { return budget::parseBudget(text); },
            "hold this frame time: milliseconds, or a share of the full-quality frame")
            ->type_name("16.6ms|40%")
            ->group("Run");
    addControllerOptions(*command, o->controller);
    command
        ->add_flag("--reference", o->reference,
                   "also render at full quality and report PSNR, SSIM and FLIP against it")
        ->group("Run");
    CLI::Option* tuned =
        command
            ->add_flag("--auto", o->tuned,
                       "choose the rate of each term for --budget in a warm-up, as calibrate does")
            ->needs(budget)
            ->group("Run");
    CLI::Option* settings = command
                                ->add_option("--settings", o->settingsFile,
                                             "take the rates from this file, which calibrate wrote")
                                ->type_name("FILE")
                                ->excludes(tuned)
                                ->group("Run");
    command
        ->add_option(
            "--outside", o->outside,
            "also write NAME.outside.png: what was drawn of the last frame, seen from this "
            "camera of the scene; what was culled is missing")
        ->type_name("CAMERA")
        ->group("Geometry");
    addLeverOptions(*command, o->levers);
    for (CLI::Option* chosen : {tuned, settings})
        chosen->excludes(command->get_option("--shading-rate"));
    addGeometryOptions(*command, o->settings);
    addCaptureOptions(*command, o->capture);
    command->get_option("--capture-rate")
        ->description(
            "samples a pixel: 1, 4, 16 or 64; above 1 the frame is captured, compacted and every "
            "surface of a pixel weighs its samples: anti-aliased");
    addFrameOptions(*command, o->settings);
    addParsed(*command, "--aov", o->aovs, parseAovs,
              "also write these as EXR beside --out: depth, normal, albedo, roughness, metallic, "
              "occlusion, id, shadow, ao, ssao, motion")
        ->type_name("NAME[,NAME]");
    addJsonOption(*command, o->json);
    addDeviceOption(*command, o->device.device);
    command->add_flag("--validate", o->device.validation, "run under the Vulkan validation layers");
    command->callback([o, &exitCode] { exitCode = finish(run(*o)); });
}

}  // namespace lodestar::app

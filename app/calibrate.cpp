// SPDX-License-Identifier: Apache-2.0
#include "app/calibrate.hpp"

#include <memory>

#include <fmt/format.h>

#include "app/camera_path.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/judge.hpp"
#include "app/tune.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

struct Options {
    std::string scene;
    gpu::DeviceRequest device;
    ViewOptions view;
    frame::FrameSettings settings;
    TuneOptions tune;
    CameraPath path;
    std::size_t views = 1;
    fs::path out;
};

Result<void> run(Options options) {
    auto session = openSession(options.scene, options.device);
    if (!session) return tl::unexpected(session.error());
    const auto camera = resolveCamera(*session, options.view);
    if (!camera) return tl::unexpected(camera.error());
    options.settings.size = vk::Extent2D{static_cast<std::uint32_t>(options.view.size.width),
                                         static_cast<std::uint32_t>(options.view.size.height)};
    std::vector<scene::Camera> cameras;
    for (std::size_t i = 0; i < options.views; ++i)
        cameras.push_back(options.path.at(*camera, i, options.views));
    frame::Frame frame(*session->device, *session->gpuScene, options.settings);
    fmt::print("{} at {}x{} on {}\n", printable(options.scene), options.view.size.width,
               options.view.size.height, session->device->description().name);
    const auto tuning = tune(*session->device, frame, cameras, options.tune);
    if (!tuning) return tl::unexpected(tuning.error());
    printTuning(*tuning);

    Report report;
    describeDevice(*session, report);
    report.settings = settingsJson(frame.settings());
    report.settings.update(leversJson(tuning->levers));
    report.settings["rounds"] = options.tune.rounds;
    report.settings["views"] = options.views;
    report.frameMs = tuning->choice().ms;
    report.counts = countsOf(*session, frame);
    report.more = tuningJson(*tuning);
    if (auto done = writeJson(options.out, toJson(report)); !done) return done;
    fmt::print("wrote {}\n", options.out.string());
    return validationVerdict(*session->device);
}

}  // namespace

void addCalibrate(CLI::App& app, int& exitCode) {
    auto o = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "calibrate",
        "measure what each term of the shading costs and what resizing it does to the picture, and "
        "write the rates of least error within a budget, for render --settings");
    addSceneArgument(*command, o->scene);
    command->add_option("--out", o->out, "the settings, as JSON")->type_name("FILE")->required();
    addParsed(
        *command, "--budget", o->tune.budget,
        [](const std::string& text) { return budget::parseBudget(text); },
        "the frame time to stay in: milliseconds, or a share of the full-quality frame")
        ->type_name("16.6ms|40%")
        ->default_str("50%");
    command
        ->add_option("--rounds", o->tune.rounds, "times each split is rendered; the median counts")
        ->type_name("N")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    addParsed(*command, "--path", o->path, parsePath,
              "where --views lie: orbit[:DEGREES], dolly[:FRACTION] or a JSON file of cameras")
        ->type_name("PATH");
    command->add_option("--views", o->views, "cameras along --path that are measured")
        ->type_name("N")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    addViewOptions(*command, o->view);
    addRepairOption(*command, o->tune.repair);
    addLocalRateOption(*command, o->tune.localRate);
    addFrameOptions(*command, o->settings);
    addDeviceOption(*command, o->device.device);
    command->add_flag("--validate", o->device.validation, "run under the Vulkan validation layers");
    command->callback([o, &exitCode] { exitCode = finish(run(*o)); });
}

}  // namespace lodestar::app

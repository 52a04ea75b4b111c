// SPDX-License-Identifier: Apache-2.0
#include "app/bench/bench.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "app/bench/benches.hpp"
#include "app/bench/results.hpp"
#include "app/camera_path.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/geometry_options.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

const Bench* findBench(const std::string& name) {
    const auto& all = benches();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Bench& b) { return b.name == name; });
    return found == all.end() ? nullptr : &*found;
}

/// What `options` leave open, as the bench has it for the device.
BenchOptions scoped(const Bench& bench, BenchOptions o, const CLI::App& command) {
    if (!bench.onCpu && !bench.onGpu) return o;
    const bool cpu = gpu::Device(o.device).description().type == "Cpu";
    const Scope scope =
        (cpu ? bench.onCpu : bench.onGpu).value_or(Scope{o.view.size, o.rounds, o.frames});
    o.everySize = !cpu && command.count("--size") == 0;
    if (command.count("--size") == 0) o.view.size = scope.size;
    if (command.count("--rounds") == 0) o.rounds = scope.rounds;
    if (command.count("--frames") == 0) o.frames = scope.frames;
    return o;
}

}  // namespace

const std::vector<Bench>& benches() {
    static const std::vector<Bench> all{
        shadingRateBench(),
        framebufferLodBench(),
        sigmaBench(),
        splitBench(),
        shadingFlickerBench(),
        framerateControlBench(),
        budgetHoldBench(),
        scalingFiltersBench(),
        temporalBench(),
        ssaoBench(),
        dofBench(),
        motionBlurBench(),
        visibilityQualityBench(),
        visibilityMemoryBench(),
        visibilityTimeBench(),
        geometryLodBench(),
        cullingScaleBench(),
        lodQualityBench(),
        lodPopsBench(),
#ifdef LODESTAR_OSG
        sceneGraphBench(),
#endif
    };
    return all;
}

void makeQuick(BenchOptions& options) {
    if (options.scene.empty()) options.scene = "builtin:columns";
    options.view.size = {160, 90};
    options.rounds = 3;
    options.frames = 45;
}

Result<std::vector<BenchCase>> benchCases(const BenchOptions& options,
                                          const std::vector<BenchCase>& defaults) {
    if (!options.scene.empty())
        return std::vector{BenchCase{options.scene, options.view.camera, options.path}};
    const auto inFolder = [](const BenchCase& one) { return !one.scene.starts_with("builtin:"); };
    if (std::none_of(defaults.begin(), defaults.end(), inFolder)) return defaults;
    fs::path folder = options.scenes;
    if (folder.empty())
        if (const char* given = std::getenv("LODESTAR_SCENES")) folder = given;
    if (folder.empty())
        return fail(
            "no folder of scenes: give --scenes DIR or set LODESTAR_SCENES; or measure "
            "another scene with --scene, or a built-in one with --quick");
    std::vector<BenchCase> cases = defaults;
    for (BenchCase& one : cases) {
        if (!inFolder(one)) continue;
        const fs::path file = folder / one.scene;
        std::error_code ignored;
        if (!fs::exists(file, ignored))
            return fail(
                fmt::format("{}: no such scene: give --scenes the folder that has it, or "
                            "measure another with --scene",
                            file.string()));
        one.scene = file.string();
        if (!options.path.empty()) one.path = options.path;
    }
    return cases;
}

Result<Json> runBench(const std::string& name, const BenchOptions& given) {
    const Bench* bench = findBench(name);
    if (bench == nullptr) throw std::invalid_argument("runBench: no bench '" + name + "'");
    BenchOptions options = given;
    options.settings.size = vk::Extent2D{static_cast<std::uint32_t>(options.view.size.width),
                                         static_cast<std::uint32_t>(options.view.size.height)};
    std::error_code error;
    fs::create_directories(options.out, error);
    if (error)
        return fail(fmt::format("{}: {}: give --out a folder that can be made",
                                options.out.string(), error.message()));

    const auto noteSettings = [&](BenchResult& of) {
        Json& settings = of.report.settings;
        settings["rounds"] = options.rounds;
        settings["width"] = options.view.size.width;
        settings["height"] = options.view.size.height;
    };
    std::size_t shown = 0;
    options.rowsCame = [&](const BenchResult& soFar) -> Result<void> {
        for (; shown < soFar.rows.size(); ++shown)
            fmt::print("{}\n", rowText(*bench, soFar.rows[shown]));
        std::fflush(stdout);
        BenchResult unfinished = soFar;
        unfinished.bars = bench->bars(soFar.rows);
        noteSettings(unfinished);
        const auto written = writeResult(*bench, unfinished, options.out);
        return written ? Result<void>() : tl::unexpected(written.error());
    };
    auto result = bench->run(options);
    if (!result) return tl::unexpected(result.error());
    result->bars = bench->bars(result->rows);
    noteSettings(*result);
    const auto written = writeResult(*bench, *result, options.out);
    if (!written) return tl::unexpected(written.error());
    fmt::print("\n{}\n", resultText(*bench, *written));
    for (const fs::path& file : result->files) fmt::print("wrote {}\n", file.string());
    fmt::print("wrote {0}.csv\nwrote {0}.json\n", (options.out / name).string());
    return *written;
}

Result<OpenCase> openCase(const BenchCase& what, const BenchOptions& options) {
    auto session = openSession(what.scene, options.device, what.opaque);
    if (!session) return tl::unexpected(session.error());
    ViewOptions view = options.view;
    view.camera = what.camera;
    const auto camera = resolveCamera(*session, view);
    if (!camera) return tl::unexpected(camera.error());
    fmt::print("{} at {}x{} on {}\n", printable(what.scene), view.size.width, view.size.height,
               session->device->description().name);
    return OpenCase{std::move(*session), *camera};
}

std::string sceneSlug(const std::string& scene) {
    std::string name =
        scene.starts_with("builtin:") ? scene.substr(8) : fs::path(scene).stem().string();
    std::replace(name.begin(), name.end(), ':', '-');
    return name;
}

Json finiteOrNull(double value) {
    return std::isfinite(value) ? Json(value) : Json();
}

double numberOrInfinity(const Json& row, const char* key) {
    const Json& value = row.at(key);
    return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

void addBench(CLI::App& app, int& exitCode) {
    auto o = std::make_shared<BenchOptions>();
    auto name = std::make_shared<std::string>();
    auto quick = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand(
        "bench", "measure one figure or table; `lodestar bench list` names them");
    std::vector<std::string> names{"list", "all"};
    for (const Bench& bench : benches()) names.push_back(bench.name);
    command
        ->add_option("NAME", *name,
                     "list, all, or the bench to run (`lodestar bench list` names them)")
        ->type_name("")
        ->required()
        ->check(CLI::IsMember(names));
    command
        ->add_option("--out", o->out,
                     "folder for NAME.json, NAME.csv and pictures, and for results.json and "
                     "results.md: the newest run there of each bench")
        ->type_name("DIR");
    command->add_flag("--quick", *quick,
                      "under a minute: builtin:columns at 160x90, few rounds, same columns");
    command
        ->add_option("--scenes", o->scenes,
                     "folder of the default scenes; without it $LODESTAR_SCENES")
        ->type_name("DIR");
    CLI::Option* scene =
        command->add_option("--scene", o->scene, "measure this scene in place of the default ones")
            ->type_name("SCENE");
    CLI::Option* rounds =
        command->add_option("--rounds", o->rounds, "times each case is measured; the median counts")
            ->type_name("N")
            ->check(CLI::Range(1, 1000))
            ->capture_default_str();
    CLI::Option* frames =
        command->add_option("--frames", o->frames, "frames of a run under a budget")
            ->type_name("N")
            ->check(CLI::Range(std::size_t{20}, std::size_t{100000}))
            ->capture_default_str();
    addParsed(
        *command, "--budget", o->budget,
        [](const std::string& text) { return budget::parseBudget(text); },
        "the budget to hold: milliseconds, or a share of the full-quality frame")
        ->type_name("16.6ms|50%");
    const auto checkedPath = [](const std::string& text) -> Result<std::string> {
        if (const auto path = parsePath(text); !path) return tl::unexpected(path.error());
        return text;
    };
    addParsed(*command, "--path", o->path, checkedPath,
              "camera path under a budget: orbit[:DEGREES], dolly[:FRACTION] or a JSON file")
        ->type_name("PATH");
    addViewOptions(*command, o->view);
    for (const char* option : {"--camera", "--eye"}) command->get_option(option)->needs(scene);
    addGeometryOptions(*command, o->settings);
    addFrameOptions(*command, o->settings);
    addDeviceOption(*command, o->device.device);
    command->add_flag("--validate", o->device.validation,
                      "run under the Vulkan validation layers (times then mean little)");
    command->callback([=, &exitCode] {
        if (*name == "list") {
            Table table({{"bench"}, {"measures"}});
            for (const Bench& bench : benches()) table.row({bench.name, bench.what});
            fmt::print("{}", table.text());
            exitCode = kExitOk;
            return;
        }
        if (o->out.empty()) throw CLI::RequiredError("--out");
        if (*quick) {
            const BenchOptions asked = *o;
            makeQuick(*o);
            if (command->count("--size") > 0) o->view.size = asked.view.size;
            if (rounds->count() > 0) o->rounds = asked.rounds;
            if (frames->count() > 0) o->frames = asked.frames;
        }
        exitCode = kExitOk;
        for (const Bench& bench : benches()) {
            if (*name != "all" && *name != bench.name) continue;
            if (*name == "all") fmt::print("\n# {}: {}\n\n", bench.name, bench.what);
            const auto done = runBench(bench.name, *quick ? *o : scoped(bench, *o, *command));
            // One that fails, for want of a scene say, does not keep the others from running.
            const int code = finish(done ? Result<void>() : tl::unexpected(done.error()));
            if (code != kExitOk) exitCode = code;
        }
    });
}

}  // namespace lodestar::app

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
#include "app/camera_path.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/geometry_options.hpp"
#include "app/whole_file.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

/// A cell as people read it: the unit is in the key.
std::string cellText(const std::string& key, const Json& row) {
    const auto found = row.find(key);
    if (found == row.end()) return "";
    if (found->is_null()) return "–";
    if (found->is_string()) return printable(found->get<std::string>());
    const double value = found->get<double>();
    if (key.ends_with("_ms")) return formatMs(value);
    if (key.ends_with("_db")) return fmt::format("{:.1f} dB", value);
    if (key.ends_with("_bytes")) return formatBytes(static_cast<std::uint64_t>(value));
    if (key.ends_with("_share")) return fmt::format("{:.1f} %", 100 * value);
    if (found->is_number_integer()) return found->dump();
    return fmt::format("{:.{}f}", value, key == "ssim" || key == "flip" ? 4 : 2);
}

/// "edge_psnr_db" → "edge psnr": cells say the unit.
std::string headingOf(std::string key) {
    for (const char* unit : {"_ms", "_db", "_share", "_bytes"})
        if (key.ends_with(unit)) key.resize(key.rfind('_'));
    std::replace(key.begin(), key.end(), '_', ' ');
    return key;
}

void printRows(const Json& rows, const std::string& measures,
               const std::vector<std::string>& keys) {
    std::vector<Table::Column> columns;
    for (const std::string& key : keys) {
        const bool text = key == "scene" || key == "camera" || key == "method" || key == "path" ||
                          key == "size" || key == "culling" || key == "lod";
        columns.push_back({headingOf(key), text ? Table::Align::left : Table::Align::right});
    }
    Table table(columns);
    for (const Json& row : rows) {
        if (row.at("measures") != measures) continue;
        std::vector<std::string> cells;
        for (const std::string& key : keys) cells.push_back(cellText(key, row));
        table.row(std::move(cells));
    }
    fmt::print("\n{}\n{}", measures, table.text());
}

void printBars(const std::vector<Bar>& bars) {
    Table table({{"bar"}, {"measured", Table::Align::right}, {"goal", Table::Align::right}, {""}});
    for (const Bar& bar : bars)
        table.row({printable(bar.what),
                   std::isfinite(bar.value) ? fmt::format("{:.2f} {}", bar.value, bar.unit) : "–",
                   bar.goal, bar.holds ? "holds" : "MISSED"});
    fmt::print("\nbars\n{}", table.text());
}

Json barsJson(const std::vector<Bar>& bars) {
    Json json = Json::array();
    for (const Bar& bar : bars)
        json.push_back({{"what", bar.what},
                        {"value", finiteOrNull(bar.value)},
                        {"unit", bar.unit},
                        {"goal", bar.goal},
                        {"holds", bar.holds}});
    return json;
}

const Bench* findBench(const std::string& name) {
    const auto& all = benches();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Bench& b) { return b.name == name; });
    return found == all.end() ? nullptr : &*found;
}

std::string csvCell(const Json& value) {
    if (value.is_null()) return "";
    if (!value.is_string()) return value.dump();
    std::string text = value.get<std::string>();
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

/// One row as it comes: "key value" of its table's columns.
void printRow(const Bench& bench, const Json& row) {
    for (const auto& [measures, keys] : bench.tables) {
        if (row.at("measures") != measures) continue;
        std::string line;
        for (const std::string& key : keys)
            if (const std::string cell = cellText(key, row); !cell.empty())
                line += fmt::format("  {} {}", headingOf(key), cell);
        fmt::print("{}\n", line);
    }
}

/// DIR/NAME.json and DIR/NAME.csv.
Result<Json> writeResult(const std::string& name, const BenchOptions& options,
                         const BenchResult& result) {
    Report report = result.report;
    report.settings["rounds"] = options.rounds;
    report.more["rows"] = result.rows;
    report.more["source"] = result.source;
    report.more["bars"] = barsJson(result.bars);
    Json all = toJson(report);
    if (const auto done = writeJson(options.out / (name + ".json"), all); !done)
        return tl::unexpected(done.error());
    if (const auto done = writeWholeFile(options.out / (name + ".csv"), csvOf(result.rows)); !done)
        return tl::unexpected(done.error());
    return all;
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

    std::size_t shown = 0;
    options.rowsCame = [&](const BenchResult& soFar) -> Result<void> {
        for (; shown < soFar.rows.size(); ++shown) printRow(*bench, soFar.rows[shown]);
        std::fflush(stdout);
        BenchResult unfinished = soFar;
        unfinished.bars = bench->bars(soFar.rows);
        const auto written = writeResult(name, options, unfinished);
        return written ? Result<void>() : tl::unexpected(written.error());
    };
    auto result = bench->run(options);
    if (!result) return tl::unexpected(result.error());
    result->bars = bench->bars(result->rows);
    const auto all = writeResult(name, options, *result);
    if (!all) return all;

    for (const auto& [measures, keys] : bench->tables) printRows(result->rows, measures, keys);
    printBars(result->bars);
    fmt::print("\n");
    for (const fs::path& file : result->files) fmt::print("wrote {}\n", file.string());
    fmt::print("wrote {}\nwrote {}\n", (options.out / (name + ".csv")).string(),
               (options.out / (name + ".json")).string());
    return all;
}

Result<OpenCase> openCase(const BenchCase& what, const BenchOptions& options) {
    auto session = openSession(what.scene, options.device);
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

std::string csvOf(const Json& rows) {
    std::vector<std::string> keys;
    for (const Json& row : rows)
        for (const auto& [key, value] : row.items())
            if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    std::string text;
    for (const std::string& key : keys) text += (text.empty() ? "" : ",") + csvCell(Json(key));
    text += '\n';
    for (const Json& row : rows) {
        for (std::size_t i = 0; i < keys.size(); ++i) {
            if (i > 0) text += ',';
            if (const auto found = row.find(keys[i]); found != row.end()) text += csvCell(*found);
        }
        text += '\n';
    }
    return text;
}

void addBench(CLI::App& app, int& exitCode) {
    auto o = std::make_shared<BenchOptions>();
    auto name = std::make_shared<std::string>();
    auto quick = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand(
        "bench", "measure one figure or table; `lodestar bench list` names them");
    std::vector<std::string> names{"list"};
    for (const Bench& bench : benches()) names.push_back(bench.name);
    command
        ->add_option("NAME", *name, "list, or the bench to run (`lodestar bench list` names them)")
        ->type_name("")
        ->required()
        ->check(CLI::IsMember(names));
    command->add_option("--out", o->out, "folder for NAME.json, NAME.csv and pictures")
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
        if (const Bench& bench = *findBench(*name); !*quick && (bench.onCpu || bench.onGpu)) {
            const bool cpu = gpu::Device(o->device).description().type == "Cpu";
            const Scope scope = (cpu ? bench.onCpu : bench.onGpu)
                                    .value_or(Scope{o->view.size, o->rounds, o->frames});
            o->everySize = !cpu && command->count("--size") == 0;
            if (command->count("--size") == 0) o->view.size = scope.size;
            if (rounds->count() == 0) o->rounds = scope.rounds;
            if (frames->count() == 0) o->frames = scope.frames;
        }
        const auto done = runBench(*name, *o);
        exitCode = finish(done ? Result<void>() : tl::unexpected(done.error()));
    });
}

}  // namespace lodestar::app

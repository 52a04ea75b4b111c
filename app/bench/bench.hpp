// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <lodestar/budget/budget.hpp>
#include <lodestar/frame/frame.hpp>

#include "app/cli.hpp"
#include "app/report_json.hpp"
#include "app/session.hpp"

/// `lodestar bench`: the figures and tables of the sources, measured here. docs/bench.md says what
/// each one measures and how to read it.
namespace lodestar::app {

struct BenchResult;

struct BenchOptions {
    std::filesystem::path out;     ///< a folder, made when missing
    std::filesystem::path scenes;  ///< folder of the default scenes; empty = $LODESTAR_SCENES
    std::string scene;             ///< measured in place of the default ones, from `view`
    ViewOptions view;
    frame::FrameSettings settings;  ///< its size is that of `view`
    gpu::DeviceRequest device;
    int rounds = 9;
    std::size_t frames = 120;  ///< of a run under a budget
    budget::Budget budget{budget::Budget::Kind::relative, 0.5};
    std::string path;        ///< of the camera; empty = the bench's own
    bool everySize = false;  ///< no size was asked for, and the device can do those of the source
    /// To be called when rows were added: they are written and shown at once, so that a run that is
    /// cut off is not lost.
    std::function<Result<void>(const BenchResult&)> rowsCame = [](const BenchResult&) {
        return Result<void>();
    };
};

/// The scene, size, rounds and frames of --quick: a run under a minute with the same columns.
void makeQuick(BenchOptions&);

/// A scene, where it is seen from and how the camera moves.
struct BenchCase {
    std::string scene, camera, path;
    bool opaque = false;  ///< what is seen through in the model is drawn opaque
};

/// What was asked for in place of `defaults`, or those, found in the folder of scenes.
Result<std::vector<BenchCase>> benchCases(const BenchOptions&,
                                          const std::vector<BenchCase>& defaults);

/// A claim and what the rows say about it.
struct Bar {
    std::string what;
    double value = 0;  ///< NaN, or infinite, is written as null
    std::string unit;
    std::string goal;  ///< as people read it, such as ">= 2"
    bool holds = false;
};

struct BenchResult {
    Report report;  ///< of the first scene at full quality
    Json rows = Json::array();
    Json source = Json::array();  ///< the published rows
    std::vector<Bar> bars;
    std::vector<std::filesystem::path> files;  ///< pictures and traces written
};

/// How much is measured where nothing is asked for.
struct Scope {
    PictureSize size;
    int rounds;
    std::size_t frames;
};

struct Bench {
    std::string name, what;
    Result<BenchResult> (*run)(const BenchOptions&);
    std::vector<Bar> (*bars)(const Json& rows);
    /// Tables to print: rows whose "measures" is the first word, these columns.
    std::vector<std::pair<std::string, std::vector<std::string>>> tables;
    /// On a CPU device, that it ends within minutes, and on others; none: as BenchOptions has it.
    std::optional<Scope> onCpu, onGpu;
};

const std::vector<Bench>& benches();

/// Runs one bench: writes DIR/NAME.json, DIR/NAME.csv and its pictures, prints its tables, and
/// returns what the JSON file holds. Fails when the validation layers have anything to say. Throws
/// std::invalid_argument when there is no bench of that name.
Result<Json> runBench(const std::string& name, const BenchOptions&);

void addBench(CLI::App&, int& exitCode);

// What the benches share.

/// A case opened: its scene on the device, and where it is seen from.
struct OpenCase {
    Session session;
    scene::Camera camera;
};
/// Opens it, and says so on standard output.
Result<OpenCase> openCase(const BenchCase&, const BenchOptions&);
/// The rounds of a bench, the measured ones three by three: before each three comes one with frames
/// made anew that is not measured. Where a driver puts a kernel or an image may be worth a tenth of
/// a pass, and some methods would have the luck of it in all their rounds.
class RoundsInSets {
public:
    explicit RoundsInSets(int measuredRounds) : measured(measuredRounds) {}
    int count() const { return measured + (measured + kOfSet - 1) / kOfSet; }
    static bool opensSet(int round) { return round % (kOfSet + 1) == 0; }

private:
    static constexpr int kOfSet = 3;
    int measured;
};

/// Calls `render`, which gives gpu::FrameTimes, twice at least and until the device has worked for
/// 0.2 s: one that was idle has turned its clock down, and takes tens of milliseconds to turn it up
/// again.
template <typename Render>
void warmUp(const Render& render) {
    constexpr double kBusyMs = 200;
    double busy = 0;
    for (int i = 0; i < 2 || busy < kBusyMs; ++i) busy += std::max(render().wallMs, 0.01);
}
/// `scene` as a part of a file name: "a/sponza.glb" → "sponza", "builtin:columns" → "columns".
std::string sceneSlug(const std::string& scene);
/// JSON has no infinity and no NaN: both become null.
Json finiteOrNull(double);
/// The number under `key`, +infinity for null.
double numberOrInfinity(const Json& row, const char* key);

}  // namespace lodestar::app

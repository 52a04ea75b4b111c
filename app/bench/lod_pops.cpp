// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>

#include "app/bench/benches.hpp"
#include "app/camera_path.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/geometry_options.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::median;
using geometry::CullMode;
using geometry::LodChoice;

constexpr int kBlock = 8;  // pixels a side: some 0.2 degrees at arm's length

/// How two pictures of one view differ.
struct Change {
    double pixels = 0;      ///< share that differ by more than 4 of 255 in a channel
    double worstBlock = 0;  ///< greatest difference of the mean of a block, of 255
    double meanBlock = 0;   ///< its mean over the blocks
};

Change changeOf(const quality::RgbImage& before, const quality::RgbImage& after) {
    Change change;
    std::uint64_t changed = 0, blocks = 0;
    for (int y = 0; y < after.height; ++y)
        for (int x = 0; x < after.width; ++x) {
            int most = 0;
            for (int c = 0; c < 3; ++c)
                most = std::max(most, std::abs(int(after.at(x, y)[c]) - int(before.at(x, y)[c])));
            changed += most > 4;
        }
    change.pixels = double(changed) / (double(after.width) * after.height);
    for (int y0 = 0; y0 + kBlock <= after.height; y0 += kBlock)
        for (int x0 = 0; x0 + kBlock <= after.width; x0 += kBlock) {
            double worst = 0;
            for (int c = 0; c < 3; ++c) {
                int sum = 0;
                for (int y = y0; y < y0 + kBlock; ++y)
                    for (int x = x0; x < x0 + kBlock; ++x)
                        sum += int(after.at(x, y)[c]) - int(before.at(x, y)[c]);
                worst = std::max(worst, std::abs(sum) / double(kBlock * kBlock));
            }
            change.worstBlock = std::max(change.worstBlock, worst);
            change.meanBlock += worst;
            ++blocks;
        }
    change.meanBlock /= double(std::max<std::uint64_t>(blocks, 1));
    return change;
}

/// Along a dolly each view is drawn twice: at the levels of detail of the view before it and at its
/// own. What differs is the pop, and nothing else. Beside it what a step of the camera changes.
Result<void> measure(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const std::size_t steps = options.rounds > 5 ? 24 : 8;
    const CameraPath dolly{
        .kind = CameraPath::Kind::dolly, .amount = 0.0025f * float(steps), .keys = {}};
    Progress bar("measuring", 3 * steps);
    std::size_t done = 0;
    for (const float errorPx : {1.0f, 2.0f, 4.0f}) {
        frame::FrameSettings settings = options.settings;
        settings.skyViews = settings.shadowTaps = 0;
        if (settings.exposure == 0) settings.exposure = 1;
        settings.cull = CullMode::none;  // what is left out of one view is not missing in the next
        settings.lod = {.mode = LodChoice::Mode::error, .errorPx = errorPx, .distances = {}};
        frame::Frame frame(*session.device, *session.gpuScene, settings);
        std::vector<Change> pops, motions;
        quality::RgbImage last;
        std::vector<budget::FrameCosts> costs;
        for (std::size_t i = 0; i < steps; ++i) {
            const scene::Camera at = dolly.at(camera, i, steps);
            if (i == 0) frame.render(at, {});
            frame.renderOutside(at);
            const quality::RgbImage before = readDisplay(*session.device, frame);
            costs.push_back(costsOf(frame.render(at, {})));
            quality::RgbImage after = readDisplay(*session.device, frame);
            if (i > 0) {
                pops.push_back(changeOf(before, after));
                motions.push_back(changeOf(last, after));
            }
            last = std::move(after);
            bar.update(++done);
        }
        const auto worst = [](const std::vector<Change>& all, double Change::*field) {
            double most = 0;
            for (const Change& one : all) most = std::max(most, one.*field);
            return most;
        };
        const auto middle = [](const std::vector<Change>& all, double Change::*field) {
            std::vector<double> values;
            for (const Change& one : all) values.push_back(one.*field);
            return median(values);
        };
        result.rows.push_back({{"measures", "pops"},
                               {"scene", fs::path(what.scene).filename().string()},
                               {"camera", what.camera},
                               {"width", options.view.size.width},
                               {"height", options.view.size.height},
                               {"lod", nameOf(settings.lod)},
                               {"steps", pops.size()},
                               {"pop_pixels", middle(pops, &Change::pixels)},
                               {"motion_pixels", middle(motions, &Change::pixels)},
                               {"pop_mean", middle(pops, &Change::meanBlock)},
                               {"motion_mean", middle(motions, &Change::meanBlock)},
                               {"pop_worst", worst(pops, &Change::worstBlock)},
                               {"motion_worst", worst(motions, &Change::worstBlock)}});
        if (result.report.passes.empty()) {
            describeDevice(session, result.report);
            result.report.passes = summarisePasses(costs);
        }
    }
    bar.erase();
    return validationVerdict(*session.device);
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = benchCases(
        options, {{"builtin:mountains", "valley", ""}, {"stanford_dragon_res2.glb", "", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    for (const BenchCase& one : *cases)
        if (auto done = measure(one, options, result); !done) return tl::unexpected(done.error());
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        if (row.at("lod") != "error:1") continue;
        const std::string scene = row.at("scene");
        const double share =
            row.at("pop_mean").get<double>() / std::max(row.at("motion_mean").get<double>(), 1e-9);
        bars.push_back({"what switches change, of what a step changes: " + scene, 100 * share, "%",
                        "<= 5", share <= 0.05});
        const double worst = row.at("pop_worst").get<double>() /
                             std::max(row.at("motion_worst").get<double>(), 1e-9);
        bars.push_back({"worst 8x8 block of a switch, of a step's worst: " + scene, 100 * worst,
                        "%", "<= 50", worst <= 0.5});
    }
    return bars;
}

}  // namespace

Bench lodPopsBench() {
    return {.name = "lod-pops",
            .what = "what a change of levels of detail changes at once, beside what motion changes",
            .run = run,
            .bars = barsOf,
            .tables = {{"pops",
                        {"scene", "lod", "pop_pixels", "motion_pixels", "pop_mean", "motion_mean",
                         "pop_worst", "motion_worst"}}}};
}

}  // namespace lodestar::app

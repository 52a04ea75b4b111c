// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/constants.hpp>

#include <lodestar/budget/trace.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/flicker.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/motion.hpp"
#include "app/bench/paper_scenes.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::Levers;

constexpr std::size_t kMostFrames = 24;
constexpr float kStepDegrees = 0.25f;  // of the orbit, a frame
constexpr double kMost = 1.5;          // times the flicker of full quality

struct Way {
    const char* name;
    Levers levers;
};
constexpr std::array kWays{
    Way{"conventional", {.shadingRate = 4, .resizeAll = true}},
    Way{"full resizing", {.shadingRate = 4, .resizeAll = true}},
    Way{"fine-grained", {.shadingRate = 4}},
    Way{"fine-grained + repair", {.shadingRate = 4, .repair = kRepair}},
    Way{"fine-grained + local r", {.shadingRate = 4, .localRate = kLocalRate}},
};

frame::FrameSettings bilinear(frame::FrameSettings settings) {
    settings.reconstruct = upsample::Reconstruct::bilinear;
    return settings;
}

/// What a sequence does from its last frame to this one.
struct Step {
    double own = 0;      ///< mean |ΔI| after motion compensation
    double against = 0;  ///< mean |ΔI_test − ΔI_ref|
};

Result<void> measureScene(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const gpu::Device& device = *session.device;
    const PictureSize size = options.view.size;
    frame::Frame guided(device, *session.gpuScene, options.settings);
    frame::Frame plain(device, *session.gpuScene, bilinear(options.settings));

    const std::size_t frames = std::min(options.frames, kMostFrames);
    const quality::RgbImage black(size.width, size.height);
    std::vector<quality::RgbImage> before(kWays.size()), now(kWays.size());
    quality::RgbImage fullBefore, fullNow;
    std::vector<float> depthBefore, depthNow;
    scene::Camera cameraBefore;
    std::vector<std::vector<double>> own(kWays.size()), against(kWays.size());
    std::vector<double> full;
    Progress bar("rendering", frames * (kWays.size() + 1));
    for (std::size_t i = 0; i < frames; ++i) {
        const float angle = glm::radians(kStepDegrees * static_cast<float>(i));
        const scene::Camera view = scene::orbited(camera, camera.at, angle);
        guided.render(view, {});
        fullNow = readDisplay(device, guided);
        depthNow = gpu::as<float>(gpu::readImage(device, guided.depth()));
        for (std::size_t w = 0; w < kWays.size(); ++w) {
            frame::Frame& frame = w == 0 ? plain : guided;
            frame.render(view, kWays[w].levers);
            now[w] = readDisplay(device, frame);
            bar.update(i * (kWays.size() + 1) + w + 1);
        }
        if (i > 0) {
            const auto motion = motionBetween({cameraBefore, depthBefore}, {view, depthNow},
                                              size.width, size.height);
            full.push_back(quality::flicker(black, black, fullBefore, fullNow, &motion));
            for (std::size_t w = 0; w < kWays.size(); ++w) {
                own[w].push_back(quality::flicker(black, black, before[w], now[w], &motion));
                against[w].push_back(
                    quality::flicker(fullBefore, fullNow, before[w], now[w], &motion));
            }
        }
        std::swap(before, now);
        std::swap(fullBefore, fullNow);
        std::swap(depthBefore, depthNow);
        cameraBefore = view;
    }
    bar.erase();
    for (std::size_t w = 0; w < kWays.size(); ++w)
        result.rows.push_back(
            {{"measures", "flicker"},
             {"scene", fs::path(what.scene).filename().string()},
             {"width", size.width},
             {"height", size.height},
             {"method", kWays[w].name},
             {"r", kWays[w].levers.shadingRate},
             {"frames", frames},
             {"step_degrees", kStepDegrees},
             {"full_flicker", finiteOrNull(1000 * budget::median(full))},
             {"flicker", finiteOrNull(1000 * budget::median(own[w]))},
             {"added_flicker", finiteOrNull(1000 * budget::median(against[w]))},
             {"of_full", finiteOrNull(budget::median(own[w]) / budget::median(full))}});
    if (!result.report.device) {
        describeDevice(session, result.report);
        result.report.counts = countsOf(session, guided);
    }
    return validationVerdict(device);
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = paperCases(options);
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    for (const BenchCase& one : *cases)
        if (auto done = measureScene(one, options, result); !done)
            return tl::unexpected(done.error());
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        const std::string method = row.at("method");
        if (!method.starts_with("fine-grained")) continue;
        const double ratio = numberOrInfinity(row, "of_full");
        bars.push_back({fmt::format("flicker over full quality's, {}: {}", method,
                                    row.at("scene").get<std::string>()),
                        ratio, "x", "<= 1.5", ratio <= kMost});
    }
    return bars;
}

}  // namespace

Bench shadingFlickerBench() {
    return {.name = "shading-flicker",
            .what = "a slow orbit of the paper's scenes at r = 4: flicker against full quality's",
            .run = run,
            .bars = barsOf,
            .tables = {
                {"flicker",
                 {"scene", "method", "r", "full_flicker", "flicker", "added_flicker", "of_full"}}}};
}

}  // namespace lodestar::app

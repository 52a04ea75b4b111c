// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/camera_path.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::median;

constexpr std::array kScales{1.0f, 0.71f};
constexpr std::array<std::uint32_t, 3> kRates{1, 4, 16};
constexpr float kShutter = 0.5f;
constexpr float kOrbit = 0.035f;  // radians between the two frames

struct Case {
    std::vector<double> frameMs, motion, effect, combine;
    quality::RgbImage picture;
};

double sumOf(const gpu::FrameTimes& times, std::string_view name) {
    double ms = 0;
    for (const gpu::PassTime& pass : times.passes) ms += pass.name == name ? pass.ms : 0;
    return ms;
}

Result<void> measure(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    const auto open = openCase(what, options);
    if (!open) return tl::unexpected(open.error());
    const auto& [session, camera] = *open;
    const std::array cameras{camera, scene::orbited(camera, camera.at, kOrbit)};
    frame::FrameSettings settings = options.settings;
    frame::Frame still(*session.device, *session.gpuScene, settings);
    still.render(cameras[0], {});
    settings.exposure = still.settings().exposure;
    if (settings.post.shutter == 0) settings.post.shutter = kShutter;
    frame::Frame frame(*session.device, *session.gpuScene, settings);

    // Of a scale: without blur, then by rates.
    std::array<std::array<Case, kRates.size() + 1>, kScales.size()> all;
    Progress bar("motion blur", std::size_t(options.rounds) * kScales.size());
    warmUp([&] { return still.render(camera, {}); });
    for (int round = 0; round < options.rounds; ++round)
        for (std::size_t s = 0; s < kScales.size(); ++s) {
            for (std::size_t i = 0; i < all[s].size(); ++i) {
                budget::Levers levers{.renderScale = kScales[s]};
                if (i > 0) levers.postRates.fill(kRates[i - 1]);
                frame::Frame& used = i == 0 ? still : frame;
                used.render(cameras[0], levers);
                const auto times = used.render(cameras[1], levers);
                Case& one = all[s][i];
                one.frameMs.push_back(times.gpuMs);
                one.motion.push_back(sumOf(times, "motion"));
                one.effect.push_back(sumOf(times, "motion blur"));
                one.combine.push_back(sumOf(times, "motion blur combine"));
                if (round == 0) one.picture = readDisplay(*session.device, used);
            }
            bar.update(std::size_t(round) * kScales.size() + s + 1);
        }
    bar.erase();
    for (std::size_t s = 0; s < kScales.size(); ++s)
        for (std::size_t i = 0; i < all[s].size(); ++i) {
            const Case& one = all[s][i];
            Json row{{"measures", "motion-blur"},
                     {"scene", fs::path(what.scene).filename().string()},
                     {"camera", what.camera},
                     {"width", options.view.size.width},
                     {"height", options.view.size.height},
                     {"s", std::round(100.0 * double{kScales[s]}) / 100},
                     {"method", i == 0 ? "off" : fmt::format("rate {}", kRates[i - 1])},
                     {"shutter", i == 0 ? 0 : settings.post.shutter}};
            row["frame_ms"] = median(one.frameMs);
            row["motion_ms"] = median(one.motion);
            row["effect_ms"] = median(one.effect);
            row["combine_ms"] = median(one.combine);
            const QualityFigures q =
                qualityOf(all[s][std::min<std::size_t>(i, 1)].picture, one.picture);
            row["psnr_db"] = finiteOrNull(q.psnrDb);
            row["ssim"] = finiteOrNull(q.ssim);
            row["native_psnr_db"] = finiteOrNull(quality::psnr(all[0][i].picture, one.picture));
            result.rows.push_back(row);
            const fs::path file =
                options.out / fmt::format("motion-blur-{}-{}-{}.png", sceneSlug(what.scene),
                                          std::lround(100 * kScales[s]),
                                          i == 0 ? "off" : fmt::format("{}", kRates[i - 1]));
            if (auto done = writePng(file, one.picture); !done) return done;
            result.files.push_back(file);
        }
    if (!result.report.device) describeDevice(session, result.report);
    return validationVerdict(*session.device);
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases =
        benchCases(options, {{"city_kaykit.glb", "street", ""}, {"sponza.glb", "nave", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    for (const BenchCase& one : *cases)
        if (auto done = measure(one, options, result); !done) return tl::unexpected(done.error());
    return result;
}

/// Motion hides resolution: what S = 0.71 costs in quality, blurred and not.
std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        if (row.at("s") == 1 || row.at("method") != "rate 4") continue;
        const Json& off = *std::find_if(rows.begin(), rows.end(), [&](const Json& other) {
            return other.at("scene") == row.at("scene") && other.at("s") == row.at("s") &&
                   other.at("method") == "off";
        });
        const double gained =
            numberOrInfinity(row, "native_psnr_db") - numberOrInfinity(off, "native_psnr_db");
        bars.push_back(
            {"S = 0.71 against 1, blurred over not: " + row.at("scene").get<std::string>(), gained,
             "dB", "> 0", gained > 0});
    }
    return bars;
}

}  // namespace

Bench motionBlurBench() {
    return {.name = "motion-blur",
            .what = "motion blur of an orbiting camera at S = 1 and 0.71",
            .run = run,
            .bars = barsOf,
            .tables = {{"motion-blur",
                        {"scene", "s", "method", "frame_ms", "motion_ms", "effect_ms", "combine_ms",
                         "psnr_db", "ssim", "native_psnr_db"}}}};
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include <fmt/format.h>

#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/depth_edges.hpp"
#include "app/bench/paper_scenes.hpp"
#include "app/bench/published.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

constexpr float kLarge = std::numeric_limits<float>::infinity();
constexpr std::array kRates{7.3f, 2.0f};  // those of Figure 1

/// Figure 1's columns, from the left, and the last in the paper's own packing.
struct Widths {
    const char* name;
    bool smallZ, smallN;
    upsample::Packing packing = upsample::Packing::full;
};
constexpr std::array kWidths{
    Widths{"large z, large n", false, false},
    Widths{"small z, large n", true, false},
    Widths{"large z, small n", false, true},
    Widths{"small z, small n", true, true},
    Widths{"the same, packed as RGBA16", true, true, upsample::Packing::yang},
};
constexpr std::size_t kLargeBoth = 0, kSmallBoth = 3;

struct Shown {
    const Widths* widths;
    float rate;
    bool resizeAll;
    quality::RgbImage picture;
};

/// The columns of the figure side by side, of the region where the first is worst.
Result<void> writeCrops(const std::vector<Shown>& shown, const quality::RgbImage& full,
                        const std::vector<std::uint8_t>& edges, const fs::path& stem,
                        std::vector<fs::path>& files) {
    for (const float rate : kRates)
        for (const bool resizeAll : {true, false}) {
            std::vector<const quality::RgbImage*> row;
            for (const Shown& one : shown)
                if (one.rate == rate && one.resizeAll == resizeAll) row.push_back(&one.picture);
            const Region region = worstRegion(full, *row.front(), edges, 160, 120);
            row.push_back(&full);
            files.push_back(fmt::format("{}.{}.r{:g}.crops.png", stem.string(),
                                        resizeAll ? "full-resizing" : "fine-grained", rate));
            if (auto done = writePng(files.back(), cropsSideBySide(row, region, 3)); !done)
                return done;
        }
    return {};
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = benchCases(options, {{kPaperScenes[0].file, kPaperScenes[0].camera, ""}});
    if (!cases) return tl::unexpected(cases.error());
    const BenchCase& what = cases->front();
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const gpu::Device& device = *session.device;

    BenchResult result;
    std::vector<Shown> shown;
    quality::RgbImage full;
    std::vector<std::uint8_t> edges;
    for (const Widths& widths : kWidths) {
        frame::FrameSettings settings = options.settings;
        settings.reconstruct = upsample::Reconstruct::bilateral;
        settings.packing = widths.packing;
        if (!widths.smallZ) settings.sigmas.z = kLarge;
        if (!widths.smallN) settings.sigmas.n = kLarge;
        frame::Frame frame(device, *session.gpuScene, settings);
        const gpu::FrameTimes whole = frame.render(camera, {});
        if (full.rgb.empty()) {
            full = readDisplay(device, frame);
            const auto depth = gpu::as<float>(gpu::readImage(device, frame.depth()));
            edges = depthEdgeMask(depth, options.view.size.width, options.view.size.height);
            describeDevice(session, result.report);
            result.report.settings = settingsJson(options.settings);
            result.report.passes = summarisePasses({costsOf(whole)});
            result.report.frameMs = whole.gpuMs;
            result.report.counts = countsOf(session, frame);
        }
        for (const bool resizeAll : {true, false})
            for (const float rate : kRates) {
                frame.render(camera, {.shadingRate = rate, .resizeAll = resizeAll});
                shown.push_back({&widths, rate, resizeAll, readDisplay(device, frame)});
                const quality::RgbImage& picture = shown.back().picture;
                const QualityFigures q = qualityOf(full, picture);
                result.rows.push_back(
                    {{"measures", "sigma"},
                     {"scene", fs::path(what.scene).filename().string()},
                     {"width", options.view.size.width},
                     {"height", options.view.size.height},
                     {"method", resizeAll ? "full resizing" : "fine-grained"},
                     {"r", rate},
                     {"widths", widths.name},
                     {"sigma_z", finiteOrNull(settings.sigmas.z)},
                     {"sigma_n", finiteOrNull(settings.sigmas.n)},
                     {"psnr_db", finiteOrNull(q.psnrDb)},
                     {"ssim", finiteOrNull(q.ssim)},
                     {"flip", q.flip},
                     {"edge_psnr_db", finiteOrNull(quality::psnr(full, picture, edges))}});
            }
    }
    if (auto done = writeCrops(shown, full, edges, options.out / "sigma", result.files); !done)
        return tl::unexpected(done.error());
    result.source = Json::array({{{"source", "Yang et al. 2008, Figure 1"}, {"r", kRates}}});
    if (auto verdict = validationVerdict(device); !verdict) return tl::unexpected(verdict.error());
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    // What the figure shows: with both widths small the edges hold, with both large they do not.
    std::vector<Bar> bars;
    const auto at = [&](const std::string& method, double r, const char* widths) {
        for (const Json& row : rows)
            if (row.at("method") == method && std::abs(row.at("r").get<double>() - r) < 0.01 &&
                row.at("widths") == widths)
                return numberOrInfinity(row, "edge_psnr_db");
        return 0.0;
    };
    for (const char* method : {"full resizing", "fine-grained"})
        for (const double r : {7.3, 2.0}) {
            const double gain =
                at(method, r, kWidths[kSmallBoth].name) - at(method, r, kWidths[kLargeBoth].name);
            bars.push_back(
                {fmt::format("small over large widths at depth edges, {}, r = {:g}", method, r),
                 gain, "dB", "> 0", gain > 0});
        }
    return bars;
}

}  // namespace

Bench sigmaBench() {
    return {.name = "sigma",
            .what = "the paper's Figure 1: large and small widths of the depth and normal filters",
            .run = run,
            .bars = barsOf,
            .tables = {
                {"sigma",
                 {"scene", "method", "r", "widths", "psnr_db", "edge_psnr_db", "ssim", "flip"}}}};
}

}  // namespace lodestar::app

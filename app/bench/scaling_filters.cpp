// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/depth_edges.hpp"
#include "app/bench/filter_runs.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::median;
using scale::Filter;

constexpr std::array kScales{0.5f, 0.71f, 1.0f, 1.41f, 2.0f};
constexpr std::size_t kNative = 2, kSupersampled = 4;  // of kScales
constexpr std::size_t kFilters = scale::kFilterNames.size();
constexpr int kWarmUp = 1;
/// Share of the frame that capture and culling may take where pixels are what costs.
constexpr double kPixelBound = 0.2;

/// What one filter made of the pictures of one S.
struct Scaled {
    std::vector<double> ms;
    quality::RgbImage picture;
};

struct AtScale {
    std::vector<double> frameMs;
    std::vector<budget::FrameCosts> costs;
    std::array<Scaled, kFilters> filters;
};

Json rowStart(const char* measures, const BenchCase& what, const BenchOptions& options, float s) {
    return {{"measures", measures},
            {"scene", fs::path(what.scene).filename().string()},
            {"camera", what.camera},
            {"width", options.view.size.width},
            {"height", options.view.size.height},
            {"s", std::round(100.0 * double{s}) / 100}};
}

double passShare(const std::vector<budget::FrameCosts>& costs,
                 std::initializer_list<std::string_view> names) {
    std::vector<double> shares;
    for (const budget::FrameCosts& frame : costs) {
        double ms = 0;
        for (const budget::PassCost& pass : frame.passes)
            if (std::find(names.begin(), names.end(), pass.name) != names.end()) ms += pass.ms;
        shares.push_back(ms / frame.gpuMs);
    }
    return median(shares);
}

void addRows(const std::array<AtScale, kScales.size()>& all, const std::vector<std::uint8_t>& edges,
             const BenchCase& what, const BenchOptions& options, Json& rows) {
    const std::size_t bilinear = std::size_t(Filter::bilinear);
    const auto& native = all[kNative].filters[bilinear].picture;
    const auto& supersampled = all[kSupersampled].filters[bilinear].picture;
    const double geometry = passShare(
        all[kNative].costs,
        {"capture", "cull clusters", "cull triangles", "compact", "emit", "cull", "shadow map"});
    for (std::size_t i = 0; i < kScales.size(); ++i) {
        Json frame = rowStart("frame", what, options, kScales[i]);
        frame["method"] = "frame";
        frame["frame_ms"] = median(all[i].frameMs);
        frame["frame_max_ms"] = *std::max_element(all[i].frameMs.begin(), all[i].frameMs.end());
        frame["times_native"] = median(all[i].frameMs) / median(all[kNative].frameMs);
        frame["geometry_share"] = geometry;
        for (const PassTimes& pass : summarisePasses(all[i].costs)) {
            std::string key = pass.name + "_ms";
            std::replace(key.begin(), key.end(), ' ', '_');
            frame[key] = pass.median;
        }
        rows.push_back(frame);
        for (std::size_t f = 0; f < kFilters; ++f) {
            const Scaled& scaled = all[i].filters[f];
            Json row = rowStart("filter", what, options, kScales[i]);
            row["method"] = scale::kFilterNames[f];
            row["scale_ms"] = median(scaled.ms);
            row["times_bilinear"] = median(scaled.ms) / median(all[i].filters[bilinear].ms);
            const QualityFigures q = qualityOf(native, scaled.picture);
            row["psnr_db"] = finiteOrNull(q.psnrDb);
            row["ssim"] = finiteOrNull(q.ssim);
            row["flip"] = q.flip;
            row["edge_psnr_db"] = finiteOrNull(quality::psnr(native, scaled.picture, edges));
            row["supersampled_psnr_db"] = finiteOrNull(quality::psnr(supersampled, scaled.picture));
            rows.push_back(row);
        }
    }
}

Result<void> writePictures(const std::array<AtScale, kScales.size()>& all,
                           const std::vector<std::uint8_t>& edges, const BenchCase& what,
                           const BenchOptions& options, std::vector<fs::path>& files) {
    const auto write = [&](const std::string& name, const quality::RgbImage& picture) {
        files.push_back(options.out /
                        fmt::format("scaling-filters.{}.{}.png", sceneSlug(what.scene), name));
        return writePng(files.back(), picture);
    };
    const auto& native = all[kNative].filters[0].picture;
    const auto& half = all[0].filters;
    const int side = std::min(96, native.height);
    const Region region =
        worstRegion(native, half[std::size_t(Filter::bilinear)].picture, edges, side, side);
    std::vector<const quality::RgbImage*> shown{&native};
    for (const Filter filter : {Filter::point, Filter::bilinear, Filter::bicubic,
                                Filter::noiseOffset, Filter::edgeAdaptive})
        shown.push_back(&half[std::size_t(filter)].picture);
    if (auto done = write("native", native); !done) return done;
    if (auto done = write("half-edge-adaptive", *shown.back()); !done) return done;
    return write("crops", cropsSideBySide(shown, region, 3));
}

Result<void> measureScene(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const gpu::Device& device = *session.device;
    frame::FrameSettings settings = options.settings;
    settings.maxScale = kScales.back();
    frame::Frame frame(device, *session.gpuScene, settings);
    FilterRuns runs(device, settings.size);

    std::array<AtScale, kScales.size()> all;
    std::vector<std::uint8_t> edges;
    Progress bar("measuring", static_cast<std::size_t>(options.rounds + kWarmUp) * kScales.size());
    std::size_t done = 0;
    warmUp([&] { return frame.render(camera, {}); });
    for (int round = -kWarmUp; round < options.rounds; ++round)
        for (std::size_t i = 0; i < kScales.size(); ++i) {
            const auto times = frame.render(camera, {.renderScale = kScales[i]});
            if (round >= 0) all[i].frameMs.push_back(times.gpuMs);
            if (round >= 0) all[i].costs.push_back(costsOf(times));
            for (std::size_t f = 0; f < kFilters; ++f) {
                scale::SpatialOptions chosen = settings.scaling;
                chosen.filter = Filter(f);
                const double ms = runs.run(frame, chosen);
                if (round >= 0) all[i].filters[f].ms.push_back(ms);
                if (round < 0) all[i].filters[f].picture = runs.picture();
            }
            if (round < 0 && i == kNative)
                edges = depthEdgeMask(gpu::as<float>(gpu::readImage(device, frame.depth())),
                                      options.view.size.width, options.view.size.height);
            bar.update(++done);
        }
    bar.erase();
    addRows(all, edges, what, options, result.rows);
    if (result.report.passes.empty()) {
        describeDevice(session, result.report);
        result.report.passes = summarisePasses(all[kNative].costs);
        result.report.frameMs = median(all[kNative].frameMs);
        result.report.counts = countsOf(session, frame);
    }
    if (auto written = writePictures(all, edges, what, options, result.files); !written)
        return written;
    if (auto done = options.rowsCame(result); !done) return done;
    return validationVerdict(device);
}

/// The times that the source gives for S = 0.71 → 1280x720.
Json publishedRows() {
    Json rows = Json::array();
    for (const auto& [method, ms] : {std::pair{"point", 0.4},
                                     {"bilinear", 0.4},
                                     {"bicubic", 3.5},
                                     {"noise", 0.5},
                                     {"noise-offset", 0.7},
                                     {"temporal", 1.1}})
        rows.push_back({{"source", "Binks 2011 (Intel HD Graphics 3000)"},
                        {"s", 0.71},
                        {"method", method},
                        {"scale_ms", ms}});
    return rows;
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = benchCases(options, {{"sponza.glb", "nave", ""},
                                            {"city_kaykit.glb", "street", ""},
                                            {"chess_abeautifulgame.glb", "pieces", ""},
                                            {"tree_ez_oak.glb", "under", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    result.source = publishedRows();
    std::vector<PictureSize> sizes{options.view.size};
    if (options.everySize) sizes.insert(sizes.begin(), {1280, 720});
    for (const BenchCase& one : *cases)
        for (const PictureSize size : sizes) {
            BenchOptions at = options;
            at.view.size = size;
            at.settings.size = vk::Extent2D{std::uint32_t(size.width), std::uint32_t(size.height)};
            if (auto done = measureScene(one, at, result); !done)
                return tl::unexpected(done.error());
        }
    return result;
}

/// The row of another filter for the same scene and scale.
const Json& sibling(const Json& rows, const Json& row, const char* method) {
    return *std::find_if(rows.begin(), rows.end(), [&](const Json& other) {
        return other.at("measures") == "filter" && other.at("scene") == row.at("scene") &&
               other.at("width") == row.at("width") && other.at("s") == row.at("s") &&
               other.at("method") == method;
    });
}

void addFilterBars(const Json& rows, const Json& ours, std::vector<Bar>& bars) {
    const Json& bicubic = sibling(rows, ours, "bicubic");
    const auto number = [](const Json& row, const char* key) { return numberOrInfinity(row, key); };
    const std::string place = fmt::format(": {} {}, S = {}", ours.at("scene").get<std::string>(),
                                          ours.at("width").dump(), ours.at("s").dump());
    for (const Json* row : {&bicubic, &ours}) {
        const double times = number(*row, "times_bilinear");
        bars.push_back({row->at("method").get<std::string>() + " / bilinear time" + place, times,
                        "x", "<= 2.2", times <= 2.2});
    }
    const double psnr = number(ours, "psnr_db") - number(bicubic, "psnr_db");
    const double edge = number(ours, "edge_psnr_db") - number(bicubic, "edge_psnr_db");
    const double flip = number(ours, "flip") / number(bicubic, "flip");
    bars.push_back({"edge-adaptive over bicubic, PSNR" + place, psnr, "dB", ">= 0", psnr >= 0});
    bars.push_back(
        {"edge-adaptive over bicubic at depth edges, PSNR" + place, edge, "dB", "> 0", edge > 0});
    bars.push_back({"edge-adaptive / bicubic FLIP" + place, flip, "x", "<= 1", flip <= 1});
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        const double s = row.at("s");
        if (row.at("method") == "edge-adaptive" && s < 1) addFilterBars(rows, row, bars);
        if (row.at("method") != "frame" || s != 0.5) continue;
        const double geometry = row.at("geometry_share"), times = row.at("times_native");
        if (geometry > kPixelBound) continue;
        bars.push_back({"frame at S = 0.5 / at 1: " + row.at("scene").get<std::string>(), times,
                        "x", "<= 0.45", times <= 0.45});
    }
    return bars;
}

}  // namespace

Bench scalingFiltersBench() {
    return {.name = "scaling-filters",
            .what = "cost and quality of each scaling filter and of the frame at S = 0.5 … 2",
            .run = run,
            .bars = barsOf,
            .tables = {{"frame",
                        {"scene", "width", "s", "frame_ms", "times_native", "capture_ms",
                         "rebuild_ms", "terms_ms", "combine_ms", "tonemap_ms", "scale_ms"}},
                       {"filter",
                        {"scene", "width", "s", "method", "scale_ms", "times_bilinear", "psnr_db",
                         "ssim", "flip", "edge_psnr_db", "supersampled_psnr_db"}}},
            .onCpu = Scope{{960, 540}, 3, 0},
            .onGpu = Scope{{1920, 1080}, 9, 0}};
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/depth_edges.hpp"
#include "app/bench/gbuffer.hpp"
#include "app/bench/published.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::median;
using upsample::Reconstruct;

constexpr std::array kRates{2.0f, 3.0f, 4.0f};
constexpr int kWarmUp = 2;  // rounds that are not measured

/// One way to render the frame, and what it cost and gave.
struct Method {
    std::string name;
    frame::Frame* frame;
    float rate;
    std::vector<budget::FrameCosts> costs;
    std::vector<double> gpuMs, wallMs;
    quality::RgbImage picture;

    void render(const scene::Camera& camera, bool measured) {
        const gpu::FrameTimes times = frame->render(camera, {.shadingRate = rate});
        if (!measured) return;
        costs.push_back(costsOf(times));
        gpuMs.push_back(times.gpuMs);
        wallMs.push_back(times.wallMs);
    }
};

/// "shadow map" → "shadow_map_ms".
std::string passKey(std::string name) {
    std::replace(name.begin(), name.end(), ' ', '_');
    return name + "_ms";
}

Json rowStart(const char* measures, const BenchCase& what, const BenchOptions& options,
              const std::string& method) {
    return {{"measures", measures},
            {"scene", fs::path(what.scene).filename().string()},
            {"camera", what.camera},
            {"width", options.view.size.width},
            {"height", options.view.size.height},
            {"method", method}};
}

Json shadingRow(const Method& method, const Method& full, const std::vector<std::uint8_t>& edges,
                const BenchCase& what, const BenchOptions& options) {
    Json row = rowStart("shading", what, options, method.name);
    const double ms = median(method.gpuMs);
    const auto [least, most] = std::minmax_element(method.gpuMs.begin(), method.gpuMs.end());
    row["r"] = method.rate;
    row["shadow_taps"] = options.settings.shadowTaps;
    row["rounds"] = method.gpuMs.size();
    row["frame_ms"] = ms;
    row["frame_min_ms"] = *least;
    row["frame_max_ms"] = *most;
    row["wall_ms"] = median(method.wallMs);
    for (const PassTimes& pass : summarisePasses(method.costs))
        row[passKey(pass.name)] = pass.median;
    row["speedup"] = median(full.gpuMs) / ms;
    if (&method == &full) return row;
    const QualityFigures q = qualityOf(full.picture, method.picture);
    row["psnr_db"] = finiteOrNull(q.psnrDb);
    row["ssim"] = finiteOrNull(q.ssim);
    row["flip"] = q.flip;
    row["edge_psnr_db"] = finiteOrNull(quality::psnr(full.picture, method.picture, edges));
    row["edge_pixels"] = std::count(edges.begin(), edges.end(), std::uint8_t{1});
    return row;
}

/// Times of the passes of AttributeComparison, round by round.
struct AttributeTimes {
    std::vector<double> capture, rebuild, gbuffer, read;

    static double passMs(const gpu::FrameTimes& times, const std::string& name) {
        for (const gpu::PassTime& pass : times.passes)
            if (pass.name == name) return pass.ms;
        return NAN;
    }
    void measure(AttributeComparison& comparison, const scene::Camera& camera, bool measured) {
        const gpu::FrameTimes a = comparison.fromVisibility(camera);
        const gpu::FrameTimes b = comparison.fromGBuffer(camera);
        if (!measured) return;
        capture.push_back(passMs(a, "capture"));
        rebuild.push_back(passMs(a, "rebuild"));
        gbuffer.push_back(passMs(b, "gbuffer"));
        read.push_back(passMs(b, "read"));
    }
    void addRows(Json& rows, const BenchCase& what, const BenchOptions& options) const {
        Json a = rowStart("attributes", what, options, "visibility");
        a["rounds"] = capture.size();
        a["capture_ms"] = median(capture);
        a["rebuild_ms"] = median(rebuild);
        a["total_ms"] = median(capture) + median(rebuild);
        Json b = rowStart("attributes", what, options, "gbuffer");
        b["rounds"] = gbuffer.size();
        b["gbuffer_ms"] = median(gbuffer);
        b["read_ms"] = median(read);
        b["total_ms"] = median(gbuffer) + median(read);
        rows.push_back(a);
        rows.push_back(b);
    }
};

Result<void> writePictures(const std::vector<Method>& methods,
                           const std::vector<std::uint8_t>& edges, const BenchCase& what,
                           const BenchOptions& options, std::vector<fs::path>& files) {
    const auto write = [&](const char* name, const quality::RgbImage& picture) -> Result<void> {
        const fs::path file =
            options.out / fmt::format("shading-rate.{}.{}.png", sceneSlug(what.scene), name);
        files.push_back(file);
        return writePng(file, picture);
    };
    const auto& full = methods.front().picture;
    const auto& bilinear = methods[methods.size() - 2].picture;
    const auto& bilateral = methods.back().picture;
    const int side = std::min(96, full.height);
    const Region region = worstRegion(full, bilinear, edges, side, side);
    if (auto done = write("full", full); !done) return done;
    if (auto done = write("r4-bilinear", bilinear); !done) return done;
    if (auto done = write("r4-bilateral", bilateral); !done) return done;
    return write("crops", cropsSideBySide({&full, &bilinear, &bilateral}, region, 4));
}

/// Full quality first, then bilinear and bilateral at each rate; the last two are those at r = 4.
std::vector<Method> makeMethods(frame::Frame& bilinear, frame::Frame& bilateral) {
    std::vector<Method> methods{{.name = "full", .frame = &bilateral, .rate = 1}};
    for (const float rate : kRates) {
        methods.push_back({.name = "bilinear", .frame = &bilinear, .rate = rate});
        methods.push_back({.name = "bilateral", .frame = &bilateral, .rate = rate});
    }
    return methods;
}

Result<void> measureScene(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const gpu::Device& device = *session.device;

    frame::FrameSettings settings = options.settings;
    settings.reconstruct = Reconstruct::bilinear;
    frame::Frame bilinear(device, *session.gpuScene, settings);
    settings.reconstruct = Reconstruct::bilateral;
    frame::Frame bilateral(device, *session.gpuScene, settings);
    std::vector<Method> methods = makeMethods(bilinear, bilateral);
    AttributeComparison comparison(device, *session.gpuScene, settings.size);
    AttributeTimes attributes;

    Progress bar("measuring",
                 static_cast<std::size_t>(options.rounds + kWarmUp) * (methods.size() + 2));
    std::size_t done = 0;
    warmUp([&] { return bilateral.render(camera, {}); });
    for (int round = -kWarmUp; round < options.rounds; ++round) {
        for (Method& method : methods) {
            method.render(camera, round >= 0);
            if (round == -1) method.picture = readDisplay(device, *method.frame);
            bar.update(++done);
        }
        attributes.measure(comparison, camera, round >= 0);
        bar.update(done += 2);
    }
    bar.erase();

    const auto depth = gpu::as<float>(gpu::readImage(device, bilateral.depth()));
    const auto edges = depthEdgeMask(depth, options.view.size.width, options.view.size.height);
    const Method& full = methods.front();
    for (const Method& method : methods)
        result.rows.push_back(shadingRow(method, full, edges, what, options));
    attributes.addRows(result.rows, what, options);
    if (result.report.passes.empty()) {
        describeDevice(session, result.report);
        result.report.passes = summarisePasses(full.costs);
        result.report.frameMs = median(full.gpuMs);
        result.report.counts = countsOf(session, *full.frame);
    }
    if (auto written = writePictures(methods, edges, what, options, result.files); !written)
        return written;
    return validationVerdict(device);
}

/// Yang et al. 2008, Figure 2. Speed-ups are ratios of its frame rates.
Json publishedRows() {
    const Json& figure = published("yang2008_fig2");
    const std::string source = fmt::format("{} ({})", figure.at("source").get<std::string>(),
                                           figure.at("hardware").get<std::string>());
    Json rows = Json::array();
    for (const Json& scene : figure.at("rows"))
        for (const auto& [key, method] :
             {std::pair{"conventional", "conventional resizing (bilinear)"},
              std::pair{"full_resize", "geometry-aware, full resizing"},
              std::pair{"fine_grained", "geometry-aware, fine-grained resizing"}}) {
            const Json& printed = scene.at(key);
            const double fps = printed.at("fps"), fullFps = scene.at("full_fps");
            rows.push_back({{"source", source},
                            {"scene", scene.at("scene")},
                            {"method", method},
                            {"r", printed.at("r")},
                            {"frame_ms", 1000 / fps},
                            {"full_frame_ms", 1000 / fullFps},
                            {"speedup", fps / fullFps},
                            {"psnr_db", printed.at("psnr_db")}});
        }
    return rows;
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = benchCases(options, {{"sponza.glb", "nave", ""},
                                            {"chess_abeautifulgame.glb", "player", ""},
                                            {"city_kaykit.glb", "street", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    result.report.settings.erase("reconstruct");  // both are measured, whatever it says
    for (const BenchCase& one : *cases)
        if (auto done = measureScene(one, options, result); !done)
            return tl::unexpected(done.error());
    result.source = publishedRows();
    return result;
}

/// The row of `like`'s scene with this method and rate; null when there is none.
const Json* sibling(const Json& rows, const Json& like, const char* method, const Json& rate) {
    for (const Json& row : rows)
        if (row.at("measures") == like.at("measures") && row.at("scene") == like.at("scene") &&
            row.at("method") == method && row.value("r", Json()) == rate)
            return &row;
    return nullptr;
}

void addShadingBars(const Json& rows, const Json& bilateral, std::vector<Bar>& bars) {
    const std::string place = fmt::format("{}, r = {:g}", bilateral.at("scene").get<std::string>(),
                                          bilateral.at("r").get<double>());
    const Json* bilinear = sibling(rows, bilateral, "bilinear", bilateral.at("r"));
    const Json* full = sibling(rows, bilateral, "full", Json(1.0f));
    if (bilinear == nullptr || full == nullptr) return;
    if (bilateral.at("edge_pixels").get<int>() > 0) {
        const double gain = numberOrInfinity(bilateral, "edge_psnr_db") -
                            numberOrInfinity(*bilinear, "edge_psnr_db");
        bars.push_back(
            {"bilateral over bilinear at depth edges: " + place, gain, "dB", ">= 2", gain >= 2});
    }
    const double extra =
        100 *
        (bilateral.at("combine_ms").get<double>() - bilinear->at("combine_ms").get<double>()) /
        full->at("frame_ms").get<double>();
    bars.push_back({"what bilateral adds to bilinear, of the full-quality frame: " + place, extra,
                    "%", "<= 15", extra <= 15});
}

void addAttributeBars(const Json& rows, const Json& visibility, std::vector<Bar>& bars) {
    const Json* gbuffer = sibling(rows, visibility, "gbuffer", Json());
    if (gbuffer == nullptr) return;
    const std::string scene = visibility.at("scene");
    const auto ms = [](const Json& row, const char* key) { return row.at(key).get<double>(); };
    const double writingAndReading =
        ms(*gbuffer, "gbuffer_ms") - ms(visibility, "capture_ms") + ms(*gbuffer, "read_ms");
    // A G-buffer drawn faster than ids, if that is ever measured, leaves nothing to stay within.
    const double marginal = writingAndReading > 0 ? ms(visibility, "rebuild_ms") / writingAndReading
                                                  : std::numeric_limits<double>::infinity();
    bars.push_back({"rebuild / (G-buffer raster - capture + read): " + scene, marginal, "x", "<= 2",
                    marginal <= 2});
    const double total = ms(visibility, "total_ms") / ms(*gbuffer, "total_ms");
    bars.push_back({"(capture + rebuild) / (G-buffer raster + read): " + scene, total, "x", "<= 2",
                    total <= 2});
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        if (row.at("method") == "bilateral") addShadingBars(rows, row, bars);
        if (row.at("method") == "visibility") addAttributeBars(rows, row, bars);
    }
    return bars;
}

}  // namespace

Bench shadingRateBench() {
    return {.name = "shading-rate",
            .what =
                "cost and quality at r = 1 … 4, bilinear and bilateral; attributes from "
                "visibility or a G-buffer",
            .run = run,
            .bars = barsOf,
            .tables = {{"shading",
                        {"scene", "method", "r", "frame_ms", "speedup", "cull_ms", "capture_ms",
                         "rebuild_ms", "terms_ms", "combine_ms", "tonemap_ms", "psnr_db", "ssim",
                         "flip", "edge_psnr_db"}},
                       {"attributes",
                        {"scene", "method", "capture_ms", "rebuild_ms", "gbuffer_ms", "read_ms",
                         "total_ms"}}}};
}

}  // namespace lodestar::app

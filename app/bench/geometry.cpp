// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/quality/flicker.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/published.hpp"
#include "app/capture.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/geometry_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::median;
using geometry::CullMode;
using geometry::LodChoice;

/// A frame of geometry and direct light: what is measured is not drowned in the shading of maps
/// that do not change from frame to frame.
frame::FrameSettings geometrySettings(const BenchOptions& options) {
    frame::FrameSettings settings = options.settings;
    settings.skyViews = 0;
    settings.shadowTaps = 0;
    settings.wavePx = 0;  // relief is the same with and without levels of detail
    if (settings.exposure == 0) settings.exposure = 1;
    return settings;
}

LodChoice allowed(float errorPx) {
    return {.mode = LodChoice::Mode::error, .errorPx = errorPx, .distances = {}};
}

/// Passes that belong to geometry: all that lists and draws triangles.
constexpr std::array kGeometryPasses{"cull", "cull triangles", "capture",     "ids",
                                     "hi-z", "cull rest",      "capture rest"};

/// The times of one way to render, round by round.
struct Times {
    std::vector<double> frameMs, wallMs, geometryMs;
    std::vector<budget::FrameCosts> costs;

    void add(const gpu::FrameTimes& times) {
        frameMs.push_back(times.gpuMs);
        wallMs.push_back(times.wallMs);
        costs.push_back(costsOf(times));
        double sum = 0;
        for (const gpu::PassTime& pass : times.passes)
            if (std::find(kGeometryPasses.begin(), kGeometryPasses.end(), pass.name) !=
                kGeometryPasses.end())
                sum += pass.ms;
        geometryMs.push_back(sum);
    }
    void write(Json& row) const {
        row["rounds"] = frameMs.size();
        row["frame_ms"] = median(frameMs);
        row["wall_ms"] = median(wallMs);
        row["geometry_ms"] = median(geometryMs);
        const auto passes = summarisePasses(costs);
        for (const char* name : kGeometryPasses) {
            std::string key = name;
            std::replace(key.begin(), key.end(), ' ', '_');
            for (const PassTimes& pass : passes)
                if (pass.name == name) row[key + "_ms"] = pass.median;
        }
    }
};

void writeCounts(const Json& counts, Json& row) {
    for (const char* key : {"instances_total", "instances_visible", "instances_hidden",
                            "clusters_visible", "triangles_total", "triangles_visible", "dropped"})
        row[key] = counts.at(key);
}

Json rowStart(const char* measures, const BenchCase& what, const BenchOptions& options) {
    return {{"measures", measures},
            {"scene", fs::path(what.scene).filename().string()},
            {"camera", what.camera},
            {"width", options.view.size.width},
            {"height", options.view.size.height}};
}

void describe(BenchResult& result, const Session& session, const Times& times, const Json& counts) {
    if (!result.report.passes.empty()) return;
    describeDevice(session, result.report);
    result.report.passes = summarisePasses(times.costs);
    result.report.frameMs = median(times.frameMs);
    result.report.counts = counts;
}

BenchResult startOf(const BenchOptions& options) {
    BenchResult result;
    result.report.settings = settingsJson(geometrySettings(options));
    return result;
}

// geometry-lod

struct Mode {
    bool lod;
    CullMode culling;
    frame::CaptureBackend capture;
};

/// What captures the frames, which is not automatic.
frame::CaptureBackend captureOf(const BenchOptions& options, const gpu::Device& device) {
    using frame::CaptureBackend;
    if (options.settings.capture != CaptureBackend::automatic) return options.settings.capture;
    return visibility::CaptureCompute::fits(device, options.settings.size)
               ? CaptureBackend::compute
               : CaptureBackend::supersample;
}

/// The six modes, and what the raster pipeline makes of the first.
std::vector<Mode> modesOf(const BenchOptions& options, const gpu::Device& device) {
    using frame::CaptureBackend;
    const CaptureBackend capture = captureOf(options, device);
    std::vector<Mode> modes;
    for (const bool lod : {false, true})
        for (const CullMode mode : {CullMode::none, CullMode::frustum, CullMode::hiz})
            modes.push_back({lod, mode, capture});
    if (capture != CaptureBackend::supersample)
        modes.push_back({false, CullMode::none, CaptureBackend::supersample});
    return modes;
}

/// One after another, not side by side: each frame's lists take memory by the scene's size.
Result<void> measureModes(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const float errorPx = options.settings.lod.errorPx;
    quality::RgbImage plain;
    const std::vector<Mode> modes = modesOf(options, *session.device);
    Progress bar("measuring", modes.size());
    std::size_t done = 0;
    for (const auto& [lod, mode, capture] : modes) {
        frame::FrameSettings settings = geometrySettings(options);
        settings.cull = mode;
        settings.capture = capture;
        settings.lod = lod ? allowed(errorPx) : LodChoice{};
        frame::Frame frame(*session.device, *session.gpuScene, settings);
        // Without culling a frame takes long, and varies little.
        const int rounds = mode == CullMode::none ? std::min(options.rounds, 3) : options.rounds;
        warmUp([&] { return frame.render(camera, {}); });
        Times times;
        for (int i = 0; i < rounds; ++i) times.add(frame.render(camera, {}));
        const quality::RgbImage picture = readDisplay(*session.device, frame);
        if (plain.rgb.empty()) plain = picture;
        Json row = rowStart("modes", what, options);
        row["capture"] = nameOf(capture);
        row["culling"] = nameOf(mode);
        row["lod"] = nameOf(settings.lod);
        times.write(row);
        const Json counts = countsOf(session, frame);
        writeCounts(counts, row);
        const QualityFigures q = qualityOf(plain, picture);
        row["psnr_db"] = finiteOrNull(q.psnrDb);
        row["ssim"] = finiteOrNull(q.ssim);
        row["flip"] = q.flip;
        result.rows.push_back(row);
        describe(result, session, times, counts);
        bar.update(++done);
        const fs::path file =
            options.out / fmt::format("geometry-lod.{}.{}.{}.{}.png", sceneSlug(what.scene),
                                      nameOf(mode), lod ? "lod" : "off", nameOf(capture));
        result.files.push_back(file);
        if (auto written = writePng(file, picture); !written) return written;
    }
    bar.erase();
    return validationVerdict(*session.device);
}

Json publishedModes() {
    const Json& fps = published("rakos2010_reader_fps_gtx550ti");
    Json rows = Json::array();
    for (const auto& [key, culling, lod] : {std::tuple{"none", "none", "off"},
                                            {"none_lod", "none", "distance"},
                                            {"icr", "frustum", "off"},
                                            {"icr_lod", "frustum", "distance"},
                                            {"icr_hiz", "hiz", "off"},
                                            {"icr_hiz_lod", "hiz", "distance"}})
        rows.push_back({{"source", "Rakos 2010, a reader's figures (GTX 550 Ti)"},
                        {"culling", culling},
                        {"lod", lod},
                        {"fps_least", fps.at(key).at(0)},
                        {"fps_most", fps.at(key).at(1)},
                        {"speedup_least",
                         fps.at(key).at(0).get<double>() / fps.at("none").at(0).get<double>()},
                        {"speedup_most",
                         fps.at(key).at(1).get<double>() / fps.at("none").at(1).get<double>()}});
    return rows;
}

Result<BenchResult> runModes(const BenchOptions& options) {
    const auto cases = benchCases(
        options, {{"builtin:mountains:14500", "valley", ""}, {"city_kaykit.glb", "street", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result = startOf(options);
    for (const BenchCase& one : *cases)
        if (auto done = measureModes(one, options, result); !done)
            return tl::unexpected(done.error());
    result.source = publishedModes();
    return result;
}

const Json* rowOf(const Json& rows, const Json& like, const char* culling, bool lod) {
    for (const Json& row : rows)
        if (row.at("scene") == like.at("scene") && row.at("capture") == like.at("capture") &&
            row.at("culling") == culling && (row.at("lod") != "off") == lod)
            return &row;
    return nullptr;
}

double ratioOf(const Json& a, const Json& b, const char* key) {
    return a.at(key).get<double>() / std::max(b.at(key).get<double>(), 1e-9);
}

std::vector<Bar> barsOfModes(const Json& rows) {
    std::vector<Bar> bars;
    const Json* allOn = nullptr;  // of the scene being looked at
    for (const Json& row : rows) {
        if (row.at("culling") != "none" || row.at("lod") != "off") continue;
        const std::string scene = row.at("scene");
        const Json *all = rowOf(rows, row, "hiz", true), *hiz = rowOf(rows, row, "hiz", false),
                   *frustum = rowOf(rows, row, "frustum", false);
        if (all == nullptr || hiz == nullptr || frustum == nullptr) {
            if (allOn == nullptr || allOn->at("scene") != row.at("scene")) continue;
            const double frames = ratioOf(row, *allOn, "frame_ms");
            bars.push_back({"frames, no culling, raster pipeline -> all on: " + scene, frames, "x",
                            ">= 15", frames >= 15});
            continue;
        }
        allOn = all;
        const double frames = ratioOf(row, *all, "frame_ms");
        bars.push_back(
            {"frames, no culling -> all on: " + scene, frames, "x", ">= 15", frames >= 15});
        const double geometry = ratioOf(row, *all, "geometry_ms");
        bars.push_back({"geometry passes, no culling -> all on: " + scene, geometry, "x", ">= 15",
                        geometry >= 15});
        const bool same = hiz->at("psnr_db").is_null() && frustum->at("psnr_db").is_null();
        bars.push_back(
            {"pictures that culling changes: " + scene, same ? 0.0 : 1.0, "", "0", same});
        const double dropped = row.at("dropped").get<double>() + all->at("dropped").get<double>();
        bars.push_back({"left out for want of place: " + scene, dropped, "", "0", dropped == 0});
    }
    return bars;
}

// culling-scale

Result<BenchResult> runScale(const BenchOptions& options) {
    BenchResult result = startOf(options);
    std::vector<std::uint64_t> counts{1'000, 10'000, 100'000, 1'000'000};
    if (options.rounds > 5) counts.push_back(10'000'000);
    for (const std::uint64_t n : counts) {
        const BenchCase what{fmt::format("builtin:instances:{}", n), "near", ""};
        auto opened = openCase(what, options);
        if (!opened) return tl::unexpected(opened.error());
        const auto& [session, camera] = *opened;
        for (const auto& [mode, lod] :
             {std::pair{CullMode::frustum, false}, std::pair{CullMode::hiz, true}}) {
            frame::FrameSettings settings = geometrySettings(options);
            settings.cull = mode;
            settings.lod = lod ? allowed(options.settings.lod.errorPx) : LodChoice{};
            // What culling is compared with is the raster pipeline's time.
            settings.capture =
                lod ? captureOf(options, *session.device) : frame::CaptureBackend::supersample;
            frame::Frame frame(*session.device, *session.gpuScene, settings);
            warmUp([&] { return frame.render(camera, {}); });
            Times times;
            for (int i = 0; i < options.rounds; ++i) times.add(frame.render(camera, {}));
            Json row = rowStart("scale", what, options);
            row["instances"] = n;
            row["capture"] = nameOf(settings.capture);
            row["culling"] = nameOf(mode);
            row["lod"] = nameOf(settings.lod);
            times.write(row);
            const Json found = countsOf(session, frame);
            writeCounts(found, row);
            row["chunks_total"] = found.at("chunks_total");
            row["chunks_visible"] = found.at("chunks_visible");
            row["visible_share"] = found.at("instances_visible").get<double>() / double(n);
            result.rows.push_back(row);
            describe(result, session, times, found);
        }
        if (auto done = validationVerdict(*session.device); !done)
            return tl::unexpected(done.error());
    }
    return result;
}

std::vector<Bar> barsOfScale(const Json& rows) {
    std::vector<Bar> bars;
    const auto find = [&](std::uint64_t n, const char* culling) -> const Json* {
        for (const Json& row : rows)
            if (row.at("instances") == n && row.at("culling") == culling) return &row;
        return nullptr;
    };
    // The least number of which the camera sees no more when there are more.
    const Json* base = find(100'000, "hiz");
    for (const std::uint64_t n : {1'000'000ull, 10'000'000ull}) {
        const Json *row = find(n, "hiz"), *uncapped = find(n, "frustum");
        if (row == nullptr || uncapped == nullptr || base == nullptr) continue;
        const double cull = row->at("cull_ms"), raster = uncapped->at("capture_ms");
        const double share = 100 * cull / raster;
        if (n == 1'000'000)
            bars.push_back({"culling of 1,000,000 instances, of that frame's raster time at LOD 0",
                            share, "%", "<= 5", share <= 5});
        const double slope =
            1e6 * (cull - base->at("cull_ms").get<double>()) / (double(n) - 100'000);
        bars.push_back({fmt::format("culling an instance more, 100,000 -> {}", formatCount(n)),
                        slope, "ns", "<= 40", slope <= 40});
    }
    return bars;
}

// lod-quality

Result<void> measureQuality(const BenchCase& what, std::uint32_t side, const OpenCase& opened,
                            const BenchOptions& options, BenchResult& result) {
    const auto& [session, camera] = opened;
    // A slow dolly, whose pictures without levels of detail are the reference.
    constexpr std::size_t kSteps = 6;
    const CameraPath dolly{.kind = CameraPath::Kind::dolly, .amount = 0.01f, .keys = {}};
    std::vector<quality::RgbImage> reference;
    std::uint64_t full = 0;
    for (const float errorPx : {0.0f, 0.5f, 1.0f, 2.0f, 4.0f}) {
        frame::FrameSettings settings = geometrySettings(options);
        settings.cull = CullMode::frustum;
        settings.captureSide = side;
        settings.lod = errorPx > 0 ? allowed(errorPx) : LodChoice{};
        frame::Frame frame(*session.device, *session.gpuScene, settings);
        frame.render(camera, {});
        Times times;
        std::vector<quality::RgbImage> pictures;
        Json counts;
        for (std::size_t i = 0; i < kSteps; ++i) {
            times.add(frame.render(dolly.at(camera, i, kSteps), {}));
            if (i == 0) counts = countsOf(session, frame);
            pictures.push_back(readDisplay(*session.device, frame));
        }
        const std::uint64_t listed = counts.at("triangles_listed");
        if (reference.empty()) {
            reference = pictures;
            full = listed;
            describe(result, session, times, counts);
        }
        std::vector<double> psnr, flip, flicker;
        for (std::size_t i = 0; i < kSteps; ++i) {
            const QualityFigures q = qualityOf(reference[i], pictures[i]);
            psnr.push_back(q.psnrDb);
            flip.push_back(q.flip);
            if (i > 0)
                flicker.push_back(
                    quality::flicker(reference[i - 1], reference[i], pictures[i - 1], pictures[i]));
        }
        Json row = rowStart("quality", what, options);
        row["samples"] = side * side;
        row["lod"] = nameOf(settings.lod);
        times.write(row);
        writeCounts(counts, row);
        row["triangles_listed"] = listed;
        row["fewer"] = double(full) / double(std::max<std::uint64_t>(listed, 1));
        row["psnr_db"] = finiteOrNull(median(psnr));
        row["flip"] = median(flip);
        row["flicker"] = median(flicker);
        result.rows.push_back(row);
    }
    return validationVerdict(*session.device);
}

Result<BenchResult> runQuality(const BenchOptions& options) {
    const auto cases = benchCases(options, {{"builtin:mountains", "valley", ""},
                                            {"city_kaykit.glb", "street", ""},
                                            {"sponza.glb", "nave", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result = startOf(options);
    for (const BenchCase& one : *cases) {
        const auto opened = openCase(one, options);
        if (!opened) return tl::unexpected(opened.error());
        for (const std::uint32_t side : {1u, 4u})
            if (auto done = measureQuality(one, side, *opened, options, result); !done)
                return tl::unexpected(done.error());
    }
    return result;
}

std::vector<Bar> barsOfQuality(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        if (row.at("lod") != "error:1") continue;
        const std::string scene =
            fmt::format("{}, {}", row.at("scene").get<std::string>(),
                        row.at("samples") == 1 ? "a sample a pixel" : "16 samples");
        const double psnr = numberOrInfinity(row, "psnr_db"), flip = row.at("flip");
        bars.push_back({"error 1 px against LOD 0: " + scene, psnr, "dB", ">= 40", psnr >= 40});
        bars.push_back({"FLIP of that: " + scene, flip, "", "<= 0.02", flip <= 0.02});
        const double fewer = row.at("fewer");
        if (scene.starts_with("builtin:mountains"))
            bars.push_back({"fewer triangles at 1 px: " + scene, fewer, "x", ">= 5", fewer >= 5});
    }
    return bars;
}

}  // namespace

Bench geometryLodBench() {
    return {.name = "geometry-lod",
            .what = "no culling, frustum, frustum and Hi-Z, each without and with levels of detail",
            .run = runModes,
            .bars = barsOfModes,
            .tables = {{"modes",
                        {"scene", "capture", "culling", "lod", "frame_ms", "geometry_ms", "cull_ms",
                         "cull_triangles_ms", "capture_ms", "hi-z_ms", "cull_rest_ms",
                         "instances_visible", "triangles_visible", "psnr_db", "flip"}}}};
}

Bench cullingScaleBench() {
    return {.name = "culling-scale",
            .what = "what culling costs for 1,000 … 10,000,000 instances, the visible ones fixed",
            .run = runScale,
            .bars = barsOfScale,
            .tables = {{"scale",
                        {"instances", "capture", "culling", "lod", "frame_ms", "cull_ms",
                         "cull_triangles_ms", "capture_ms", "hi-z_ms", "cull_rest_ms",
                         "chunks_visible", "instances_visible", "triangles_visible"}}}};
}

Bench lodQualityBench() {
    return {.name = "lod-quality",
            .what = "PSNR, FLIP, flicker and triangles by the error that levels of detail may have",
            .run = runQuality,
            .bars = barsOfQuality,
            .tables = {{"quality",
                        {"scene", "samples", "lod", "geometry_ms", "triangles_listed",
                         "triangles_visible", "fewer", "psnr_db", "flip", "flicker"}}}};
}

}  // namespace lodestar::app

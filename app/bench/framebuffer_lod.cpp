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
#include "app/bench/published.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::Levers;
using budget::median;
using budget::Term;
using upsample::Reconstruct;

constexpr int kWarmUp = 1;  // rounds that are not measured

/// A scene of the paper: which term is its expensive one, and the share of the full-quality frame
/// that it has there, (1 − 1/speed-up) / (1 − 1/r²) of Figure 2.
struct PaperScene {
    const char* name;
    const char* file;
    const char* camera;
    Term term;
    double share;
    double leastSpeedup, leastDb;  ///< of fine-grained resizing at some r
};
constexpr std::array kPaperScenes{
    PaperScene{"car", "lamborghini.glb", "front", Term::shadow, 0.93, 9.3, 42},
    PaperScene{"chess", "chess_abeautifulgame.glb", "player", Term::ao, 0.92, 6.6, 38},
    PaperScene{"dragon", "stanford_dragon_res2.glb", "side", Term::noise, 0.65, 2.6, 40},
};

/// One way to spend less than full quality.
struct Way {
    const char* name;
    Reconstruct reconstruct;
    float repair;
    bool resizeAll = false;
};
constexpr std::array kWays{
    Way{"conventional", Reconstruct::bilinear, 0, true},
    Way{"full resizing", Reconstruct::bilateral, 0, true},
    Way{"fine-grained bilinear", Reconstruct::bilinear, 0},
    Way{"fine-grained nearest-depth", Reconstruct::nearestDepth, 0},
    Way{"fine-grained", Reconstruct::bilateral, 0},
    Way{"fine-grained + repair", Reconstruct::bilateral, kRepair},
};
constexpr std::array kRates{1.5f, 2.0f, 3.0f, 3.5f, 4.0f, 5.0f, 6.0f, 8.0f};

frame::FrameSettings withLoad(frame::FrameSettings settings, Term term, std::uint32_t load) {
    settings.shadowTaps = term == Term::shadow ? load : 0;
    settings.skyViews = term == Term::ao ? shared::LS_MAX_SKY_VIEWS : 0;
    settings.skyTaps = term == Term::ao ? load : 2;
    settings.noiseOctaves = term == Term::noise ? load : 0;
    return settings;
}

std::uint32_t paperLoad(Term term) {
    return term == Term::shadow ? 9 : term == Term::ao ? 2 : 6;
}

double passMs(const gpu::FrameTimes& times, const char* name) {
    double sum = 0;
    for (const gpu::PassTime& pass : times.passes)
        if (pass.name == name) sum += pass.ms;
    return sum;
}

/// The share of the terms in the full-quality frame; medians of three.
double shareOf(frame::Frame& frame, const scene::Camera& camera) {
    std::vector<double> shares;
    frame.render(camera, {});
    for (int i = 0; i < 3; ++i) {
        const gpu::FrameTimes times = frame.render(camera, {});
        shares.push_back(passMs(times, "terms") / times.gpuMs);
    }
    return median(shares);
}

/// The load at which the term has the paper's share of the frame, from its share at the paper's own
/// load: the cost of taps grows with (N + 1)², that of octaves with their number.
std::uint32_t loadFor(Term term, double wanted, double share) {
    const double factor = wanted / (1 - wanted) * (1 - share) / share;
    const double now = paperLoad(term);
    if (term == Term::noise)
        return static_cast<std::uint32_t>(std::clamp(std::round(now * factor), 1.0, 12.0));
    return static_cast<std::uint32_t>(
        std::clamp(std::round((now + 1) * std::sqrt(factor)) - 1, 1.0, 32.0));
}

/// What was measured of one way at one rate.
struct Measured {
    const Way* way;  ///< null: full quality
    float rate = 1;
    std::vector<double> frameMs, termsMs, methodMs;
    quality::RgbImage picture;

    void add(const gpu::FrameTimes& times) {
        frameMs.push_back(times.gpuMs);
        termsMs.push_back(passMs(times, "terms"));
        methodMs.push_back(passMs(times, "upsample") + passMs(times, "pack") +
                           passMs(times, "select repair") + passMs(times, "repair"));
    }
};

Json rowOf(const Measured& m, const Measured& full, const PaperScene& paper, const BenchCase& what,
           const BenchOptions& options, std::uint32_t load,
           const std::vector<std::uint8_t>& edges) {
    const double frame = median(m.frameMs), fullMs = median(full.frameMs);
    const double k = median(full.termsMs), c = fullMs - k;
    Json row{{"measures", "framebuffer-lod"},
             {"paper_scene", paper.name},
             {"scene", fs::path(what.scene).filename().string()},
             {"width", options.view.size.width},
             {"height", options.view.size.height},
             {"term", budget::kTermNames[std::size_t(paper.term)]},
             {"load", load},
             {"method", m.way ? m.way->name : "full quality"},
             {"r", m.rate},
             {"rounds", m.frameMs.size()},
             {"frame_ms", frame},
             {"terms_ms", median(m.termsMs)},
             {"method_ms", median(m.methodMs)},
             {"term_share", k / fullMs},
             {"speedup", fullMs / frame}};
    if (!m.way) return row;
    const QualityFigures q = qualityOf(full.picture, m.picture);
    row["psnr_db"] = finiteOrNull(q.psnrDb);
    row["ssim"] = finiteOrNull(q.ssim);
    row["flip"] = q.flip;
    row["edge_psnr_db"] = finiteOrNull(quality::psnr(full.picture, m.picture, edges));
    row["of_ideal"] = frame / (c + k / (double(m.rate) * m.rate));
    row["method_share"] = median(m.methodMs) / fullMs;
    return row;
}

/// One frame for every reconstruction, at the same load.
struct Frames {
    frame::Frame bilinear, nearestDepth, bilateral;

    Frames(const gpu::Device& device, const scene::GpuScene& scene,
           const frame::FrameSettings& settings)
        : bilinear(device, scene, with(settings, Reconstruct::bilinear)),
          nearestDepth(device, scene, with(settings, Reconstruct::nearestDepth)),
          bilateral(device, scene, with(settings, Reconstruct::bilateral)) {}

    static frame::FrameSettings with(frame::FrameSettings settings, Reconstruct kind) {
        settings.reconstruct = kind;
        return settings;
    }
    frame::Frame& of(Reconstruct kind) {
        return kind == Reconstruct::bilinear       ? bilinear
               : kind == Reconstruct::nearestDepth ? nearestDepth
                                                   : bilateral;
    }
};

Result<void> measureScene(const PaperScene& paper, const BenchCase& what,
                          const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const gpu::Device& device = *session.device;

    std::uint32_t load = paperLoad(paper.term);
    {
        frame::Frame probe(device, *session.gpuScene, withLoad(options.settings, paper.term, load));
        const double share = shareOf(probe, camera);
        load = loadFor(paper.term, paper.share, share);
        fmt::print("{}: {} has {:.0f} % of the frame at the paper's load {}; measured at {}\n",
                   paper.name, budget::kTermNames[std::size_t(paper.term)], 100 * share,
                   paperLoad(paper.term), load);
    }
    Frames frames(device, *session.gpuScene, withLoad(options.settings, paper.term, load));

    std::vector<Measured> all{{.way = nullptr}};
    for (const float rate : kRates)
        for (const Way& way : kWays) all.push_back({.way = &way, .rate = rate});
    Progress bar("measuring", static_cast<std::size_t>(options.rounds + kWarmUp) * all.size());
    std::size_t done = 0;
    for (int round = -kWarmUp; round < options.rounds; ++round)
        for (Measured& m : all) {
            frame::Frame& frame = frames.of(m.way ? m.way->reconstruct : Reconstruct::bilateral);
            const Levers levers{.shadingRate = m.rate,
                                .repair = m.way ? m.way->repair : 0,
                                .resizeAll = m.way && m.way->resizeAll};
            const gpu::FrameTimes times = frame.render(camera, levers);
            if (round >= 0) m.add(times);
            if (round == -1) m.picture = readDisplay(device, frame);
            bar.update(++done);
        }
    bar.erase();

    const auto depth = gpu::as<float>(gpu::readImage(device, frames.bilateral.depth()));
    const auto edges = depthEdgeMask(depth, options.view.size.width, options.view.size.height);
    for (const Measured& m : all)
        result.rows.push_back(rowOf(m, all.front(), paper, what, options, load, edges));
    if (result.report.passes.empty()) {
        describeDevice(session, result.report);
        result.report.frameMs = median(all.front().frameMs);
        result.report.counts = countsOf(session, frames.bilateral);
    }
    for (const Measured& m : all) {
        if (m.way && m.rate != 4) continue;
        std::string name = m.way ? m.way->name : "full";
        std::replace(name.begin(), name.end(), ' ', '-');
        result.files.push_back(options.out /
                               fmt::format("framebuffer-lod.{}.{}.png", paper.name, name));
        if (auto written = writePng(result.files.back(), m.picture); !written) return written;
    }
    return validationVerdict(device);
}

Result<BenchResult> run(const BenchOptions& options) {
    std::vector<BenchCase> defaults;
    for (const PaperScene& paper : kPaperScenes) defaults.push_back({paper.file, paper.camera, ""});
    const auto cases = benchCases(options, defaults);
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    // A scene of the user's takes the part of the first; it says nothing of the others.
    for (std::size_t i = 0; i < cases->size(); ++i)
        if (auto done = measureScene(kPaperScenes[i], (*cases)[i], options, result); !done)
            return tl::unexpected(done.error());
    result.source = published("yang2008_fig2").at("rows");
    return result;
}

/// The rows of one scene and way.
std::vector<const Json*> rowsOf(const Json& rows, const char* scene, const std::string& method) {
    std::vector<const Json*> found;
    for (const Json& row : rows)
        if (row.at("paper_scene") == scene && row.at("method") == method) found.push_back(&row);
    return found;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const PaperScene& paper : kPaperScenes) {
        const auto plain = rowsOf(rows, paper.name, "fine-grained");
        const auto repaired = rowsOf(rows, paper.name, "fine-grained + repair");
        if (plain.empty()) continue;
        // The fastest row that is good enough, of those without and with repair.
        double fastest = 0;
        for (const auto& list : {plain, repaired})
            for (const Json* row : list)
                if (numberOrInfinity(*row, "psnr_db") >= paper.leastDb)
                    fastest = std::max(fastest, row->at("speedup").get<double>());
        bars.push_back({fmt::format("speed-up at {:g} dB or more: {}", paper.leastDb, paper.name),
                        fastest, "x", fmt::format(">= {:g}", paper.leastSpeedup),
                        fastest >= paper.leastSpeedup});
        double worst = 0, share = 0;
        for (const Json* row : plain) {
            const double r = row->at("r");
            if (r < 2 || r > 5) continue;
            worst = std::max(worst, row->at("of_ideal").get<double>());
            share = std::max(share, row->at("method_share").get<double>());
        }
        bars.push_back({fmt::format("frame / (C + K/r²), worst of r = 2 … 5: {}", paper.name),
                        worst, "x", "<= 1.10", worst <= 1.10});
        bars.push_back({fmt::format("reconstruction, of the full-quality frame: {}", paper.name),
                        100 * share, "%", "<= 6", share <= 0.06});
        for (std::size_t i = 0; i < plain.size() && i < repaired.size(); ++i) {
            if (plain[i]->at("r") != 4) continue;
            const double gain = numberOrInfinity(*repaired[i], "edge_psnr_db") -
                                numberOrInfinity(*plain[i], "edge_psnr_db");
            const double more = 100 * (repaired[i]->at("frame_ms").get<double>() /
                                           plain[i]->at("frame_ms").get<double>() -
                                       1);
            bars.push_back({fmt::format("repair at depth edges, r = 4: {}", paper.name), gain, "dB",
                            ">= 2", gain >= 2});
            bars.push_back({fmt::format("time repair adds, r = 4: {}", paper.name), more, "%",
                            "<= 10", more <= 10});
        }
    }
    return bars;
}

}  // namespace

Bench framebufferLodBench() {
    return {.name = "framebuffer-lod",
            .what =
                "the paper's three scenes at r = 1.5 … 8: speed-up and quality of fine-grained "
                "resizing by four reconstructions",
            .run = run,
            .bars = barsOf,
            .tables = {{"framebuffer-lod",
                        {"paper_scene", "method", "r", "frame_ms", "terms_ms", "method_ms",
                         "speedup", "of_ideal", "psnr_db", "edge_psnr_db", "ssim", "flip"}}}};
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/depth_edges.hpp"
#include "app/bench/paper_scenes.hpp"
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

/// One way to spend less than full quality.
struct Way {
    const char* name;
    Reconstruct reconstruct;
    bool repair = false;
    bool resizeAll = false;
    float localRate = 0;
};
constexpr std::array kWays{
    Way{.name = "conventional", .reconstruct = Reconstruct::bilinear, .resizeAll = true},
    Way{.name = "full resizing", .reconstruct = Reconstruct::bilateral, .resizeAll = true},
    Way{.name = "fine-grained bilinear", .reconstruct = Reconstruct::bilinear},
    Way{.name = "fine-grained nearest-depth", .reconstruct = Reconstruct::nearestDepth},
    Way{.name = "fine-grained", .reconstruct = Reconstruct::bilateral},
    Way{.name = "fine-grained + repair", .reconstruct = Reconstruct::bilateral, .repair = true},
    Way{.name = "fine-grained + local r",
        .reconstruct = Reconstruct::bilateral,
        .localRate = kLocalRate},
    Way{.name = "fine-grained + both",
        .reconstruct = Reconstruct::bilateral,
        .repair = true,
        .localRate = kLocalRate},
};
constexpr std::array kRates{1.5f, 2.0f, 3.0f, 3.5f, 4.0f, 5.0f, 6.0f, 8.0f};

/// A scene of the paper as it is shown. The dragon also before black: much of what resizing costs
/// lies at its outline, and a sky of nearly its own brightness hides that.
struct Shown {
    const PaperScene* paper;
    std::string name;
    std::optional<glm::vec3> backdrop = {};
};

std::vector<Shown> shownOf(const PaperScene& paper) {
    std::vector<Shown> all{{&paper, paper.name}};
    if (paper.term == Term::noise)
        all.push_back({&paper, fmt::format("{}, on black", paper.name), glm::vec3(0)});
    return all;
}

/// The cap at which repair takes a sixteenth of the frame at most: the dearer the terms of the
/// pixels that show something, the fewer. Pixels here and there cost half as much again as they do
/// among their neighbours.
float repairCap(double share, double covered, float rate) {
    const double frame = 1 - share + share / (double(rate) * rate);
    return static_cast<float>(std::min(double(kRepair), frame / 16 / (1.5 * share / covered)));
}

/// The share of the pixels that show something.
double coveredShare(const gpu::Device& device, const frame::Frame& frame) {
    const auto depth = gpu::as<float>(gpu::readImage(device, frame.depth()));
    const auto seen = std::count_if(depth.begin(), depth.end(), [](float z) { return z > 0; });
    return double(seen) / double(depth.size());
}

/// What was measured of one way at one rate.
struct Measured {
    const Way* way;  ///< null: full quality
    float rate = 1;
    float repair = 0;
    std::uint32_t repaired = 0, refined = 0;
    std::vector<double> frameMs, termsMs, combineMs, methodMs;
    quality::RgbImage picture;

    void add(const gpu::FrameTimes& times) {
        frameMs.push_back(times.gpuMs);
        termsMs.push_back(passMs(times, "terms"));
        combineMs.push_back(passMs(times, "combine"));
        methodMs.push_back(passMs(times, "list terms") + passMs(times, "upsample") +
                           passMs(times, "pack") + passMs(times, "refine") +
                           passMs(times, "weigh repair") + passMs(times, "select repair") +
                           passMs(times, "repair") + passMs(times, "combine repaired"));
    }
};

/// What resizing itself costs. Where combining reconstructs too, what it takes longer for it.
double methodMs(const Measured& m, const Measured& full) {
    const bool combinesOnO = m.way && !m.way->resizeAll;
    const double longer = combinesOnO ? median(m.combineMs) - median(full.combineMs) : 0;
    return median(m.methodMs) + std::max(longer, 0.0);
}

Json rowOf(const Measured& m, const Measured& full, const Shown& shown, const BenchCase& what,
           const BenchOptions& options, Load load, const std::vector<std::uint8_t>& edges) {
    const double frame = median(m.frameMs), fullMs = median(full.frameMs);
    const double k = median(full.termsMs), c = fullMs - k;
    Json row{{"measures", "framebuffer-lod"},
             {"paper_scene", shown.name},
             {"scene", fs::path(what.scene).filename().string()},
             {"width", options.view.size.width},
             {"height", options.view.size.height},
             {"term", budget::kTermNames[std::size_t(shown.paper->term)]},
             {"load", load.amount},
             {"warps", load.warps},
             {"method", m.way ? m.way->name : "full quality"},
             {"r", m.rate},
             {"rounds", m.frameMs.size()},
             {"frame_ms", frame},
             {"terms_ms", median(m.termsMs)},
             {"method_ms", methodMs(m, full)},
             {"term_share", k / fullMs},
             {"speedup", fullMs / frame}};
    if (!m.way) return row;
    const QualityFigures q = qualityOf(full.picture, m.picture);
    row["psnr_db"] = finiteOrNull(q.psnrDb);
    row["ssim"] = finiteOrNull(q.ssim);
    row["flip"] = q.flip;
    row["edge_psnr_db"] = finiteOrNull(quality::psnr(full.picture, m.picture, edges));
    row["of_ideal"] = frame / (c + k / (double(m.rate) * m.rate));
    row["repair_cap_share"] = m.repair;
    row["repaired_pixels"] = m.repaired;
    row["refined_texels"] = m.refined;
    row["method_share"] = methodMs(m, full) / fullMs;
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

Result<void> measureScene(const Shown& shown, const BenchCase& what, const BenchOptions& options,
                          BenchResult& result) {
    const PaperScene& paper = *shown.paper;
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    const gpu::Device& device = *session.device;

    frame::FrameSettings settings = options.settings;
    settings.backdrop = shown.backdrop;
    const Load load = findLoad(paper, session, camera, settings);
    settings = withLoad(settings, paper.term, load);
    auto frames = std::make_unique<Frames>(device, *session.gpuScene, settings);

    const double share = shareOf(frames->bilateral, camera);
    const double covered = coveredShare(device, frames->bilateral);
    std::vector<Measured> all{{.way = nullptr}};
    for (const float rate : kRates)
        for (const Way& way : kWays)
            all.push_back({.way = &way,
                           .rate = rate,
                           .repair = way.repair ? repairCap(share, covered, rate) : 0});
    const RoundsInSets rounds(options.rounds);
    Progress bar("measuring", static_cast<std::size_t>(rounds.count()) * all.size());
    std::size_t done = 0;
    warmUp([&] { return frames->bilateral.render(camera, {}); });
    for (int round = 0; round < rounds.count(); ++round) {
        const bool measured = !RoundsInSets::opensSet(round);
        if (!measured && round > 0)
            frames = std::make_unique<Frames>(device, *session.gpuScene, settings);
        for (Measured& m : all) {
            frame::Frame& frame = frames->of(m.way ? m.way->reconstruct : Reconstruct::bilateral);
            const Levers levers{.shadingRate = m.rate,
                                .repair = m.repair,
                                .localRate = m.way ? m.way->localRate : 0,
                                .resizeAll = m.way && m.way->resizeAll};
            const gpu::FrameTimes times = frame.render(camera, levers);
            if (measured) m.add(times);
            if (round == 0) {
                m.picture = readDisplay(device, frame);
                m.repaired = frame.repairedPixels();
                m.refined = frame.refinedTexels();
            }
            bar.update(++done);
        }
    }
    bar.erase();

    const auto depth = gpu::as<float>(gpu::readImage(device, frames->bilateral.depth()));
    const auto edges = depthEdgeMask(depth, options.view.size.width, options.view.size.height);
    for (const Measured& m : all)
        result.rows.push_back(rowOf(m, all.front(), shown, what, options, load, edges));
    if (result.report.passes.empty()) {
        describeDevice(session, result.report);
        result.report.frameMs = median(all.front().frameMs);
        result.report.counts = countsOf(session, frames->bilateral);
    }
    for (const Measured& m : all) {
        if (m.way && m.rate != 4) continue;
        std::string name = m.way ? m.way->name : "full";
        name = shown.name + "." + name;
        std::erase(name, ',');
        std::replace(name.begin(), name.end(), ' ', '-');
        result.files.push_back(options.out / fmt::format("framebuffer-lod.{}.png", name));
        if (auto written = writePng(result.files.back(), m.picture); !written) return written;
    }
    return validationVerdict(device);
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = paperCases(options);
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    for (const BenchCase& one : *cases)
        for (const Shown& shown : shownOf(roleOf(one)))
            if (auto done = measureScene(shown, one, options, result); !done)
                return tl::unexpected(done.error());
    result.source = published("yang2008_fig2").at("rows");
    return result;
}

/// The rows of one scene and way.
std::vector<const Json*> rowsOf(const Json& rows, const std::string& scene,
                                const std::string& method) {
    std::vector<const Json*> found;
    for (const Json& row : rows)
        if (row.at("paper_scene") == scene && row.at("method") == method) found.push_back(&row);
    return found;
}

/// The PSNR that a way reaches in a frame of `ms`, between its rows (by time); NaN outside them.
double dbAt(std::vector<const Json*> list, double ms) {
    std::sort(list.begin(), list.end(), [](const Json* a, const Json* b) {
        return a->at("frame_ms").get<double>() < b->at("frame_ms").get<double>();
    });
    for (std::size_t i = 1; i < list.size(); ++i) {
        const double a = list[i - 1]->at("frame_ms"), b = list[i]->at("frame_ms");
        if (ms < a || ms > b) continue;
        const double part = b > a ? std::log(ms / a) / std::log(b / a) : 0;
        const double low = numberOrInfinity(*list[i - 1], "psnr_db");
        const double high = numberOrInfinity(*list[i], "psnr_db");
        return low + part * (high - low);
    }
    return NAN;
}

/// Over the rates of `base` from `leastRate` to `mostRate`: the mean of what `other` gains in the
/// same time [dB].
double gainAtEqualTime(const std::vector<const Json*>& base, const std::vector<const Json*>& other,
                       double leastRate, double mostRate) {
    double sum = 0;
    int count = 0;
    for (const Json* row : base) {
        const double r = row->at("r");
        if (r < leastRate || r > mostRate) continue;
        const double there = dbAt(other, row->at("frame_ms"));
        if (!std::isfinite(there)) continue;
        sum += there - numberOrInfinity(*row, "psnr_db");
        ++count;
    }
    return count > 0 ? sum / count : NAN;
}

double methodAndTermsMs(const Json& row) {
    return row.at("method_ms").get<double>() + row.at("terms_ms").get<double>();
}

/// C: the median of what the frames of these ways take beside terms and method, which is the same
/// passes in all of them.
double fixedMs(const std::vector<std::vector<const Json*>>& ways) {
    std::vector<double> all;
    for (const auto& way : ways)
        for (const Json* row : way)
            all.push_back(row->at("frame_ms").get<double>() - methodAndTermsMs(*row));
    return median(all);
}

void addBars(const Shown& shown, const Json& rows, std::vector<Bar>& bars) {
    const PaperScene& paper = *shown.paper;
    const auto plain = rowsOf(rows, shown.name, "fine-grained");
    const auto repaired = rowsOf(rows, shown.name, "fine-grained + repair");
    const auto local = rowsOf(rows, shown.name, "fine-grained + local r");
    if (plain.empty()) return;
    // The fastest row that is good enough, of those without and with repair.
    double fastest = 0;
    for (const auto& list : {plain, repaired, local})
        for (const Json* row : list)
            if (numberOrInfinity(*row, "psnr_db") >= paper.leastDb)
                fastest = std::max(fastest, row->at("speedup").get<double>());
    bars.push_back({fmt::format("speed-up at {:g} dB or more: {}", paper.leastDb, shown.name),
                    fastest, "x", fmt::format(">= {:g}", paper.leastSpeedup),
                    fastest >= paper.leastSpeedup});
    // The paper compares them where conventional resizing has r = 2.
    const double over = gainAtEqualTime(rowsOf(rows, shown.name, "conventional"),
                                        rowsOf(rows, shown.name, "full resizing"), 2, 2);
    bars.push_back(
        {fmt::format("full resizing over conventional at r = 2, equal time: {}", shown.name), over,
         "dB", fmt::format(">= {:g}", paper.overBilinearDb), over >= paper.overBilinearDb});
    const double localGain = gainAtEqualTime(plain, local, 1.5, 4);
    bars.push_back({fmt::format("local r over one r, equal time: {}", shown.name), localGain, "dB",
                    "> 0", localGain > 0});
    const auto full = rowsOf(rows, shown.name, "full quality");
    const double c = fixedMs({full, plain, repaired});
    const double k = full.front()->at("terms_ms");
    double worst = 0, worstByPasses = 0, share = 0;
    for (const Json* row : plain) {
        const double r = row->at("r");
        if (r < 2 || r > 5) continue;
        worst = std::max(worst, row->at("of_ideal").get<double>());
        worstByPasses = std::max(worstByPasses, (c + methodAndTermsMs(*row)) / (c + k / (r * r)));
        share = std::max(share, row->at("method_share").get<double>());
    }
    bars.push_back({fmt::format("frame / (C + K/r²), worst of r = 2 … 5: {}", shown.name), worst,
                    "x", "<= 1.10", worst <= 1.10});
    bars.push_back({fmt::format("the same, with one C for all r: {}", shown.name), worstByPasses,
                    "x", "<= 1.10", worstByPasses <= 1.10});
    bars.push_back({fmt::format("reconstruction, of the full-quality frame: {}", shown.name),
                    100 * share, "%", "<= 6", share <= 0.06});
    for (std::size_t i = 0; i < plain.size() && i < repaired.size(); ++i) {
        if (plain[i]->at("r") != 4) continue;
        const double gain = numberOrInfinity(*repaired[i], "edge_psnr_db") -
                            numberOrInfinity(*plain[i], "edge_psnr_db");
        const double without = methodAndTermsMs(*plain[i]);
        const double more = 100 * (methodAndTermsMs(*repaired[i]) - without) / (c + without);
        bars.push_back({fmt::format("repair at depth edges, r = 4: {}", shown.name), gain, "dB",
                        ">= 2", gain >= 2});
        bars.push_back({fmt::format("time repair adds, r = 4: {}", shown.name), more, "%", "<= 10",
                        more <= 10});
    }
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const PaperScene& paper : kPaperScenes)
        for (const Shown& shown : shownOf(paper)) addBars(shown, rows, bars);
    return bars;
}

}  // namespace

Bench framebufferLodBench() {
    return {.name = "framebuffer-lod",
            .what =
                "the paper's three scenes at r = 1.5 … 8: speed-up and quality of fine-grained "
                "resizing by four reconstructions, with repair and local rates",
            .run = run,
            .bars = barsOf,
            .tables = {{"framebuffer-lod",
                        {"paper_scene", "method", "r", "frame_ms", "terms_ms", "method_ms",
                         "speedup", "of_ideal", "psnr_db", "edge_psnr_db", "ssim", "flip",
                         "repaired_pixels", "refined_texels"}}}};
}

}  // namespace lodestar::app

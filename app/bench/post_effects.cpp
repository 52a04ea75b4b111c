// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <memory>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/published.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::median;

constexpr std::array<std::uint32_t, 3> kRates{4, 16, 64};

/// One way to make an effect.
struct Method {
    const char* name;
    bool downsampled, bilateral, fullRate;
};
constexpr std::array kMethods{
    Method{"effective", false, true, false}, Method{"effective, linear", false, false, false},
    Method{"reference", true, false, false}, Method{"full rate", false, true, true}};
constexpr std::size_t kReference = 2, kFull = 3;

/// An effect, and which passes of the frame make it.
struct Subject {
    const char* name;
    void (*enable)(frame::PostSettings&);
    std::vector<std::string_view> inputs, effect, combine;
};

Subject ssaoSubject() {
    return {"ssao",
            [](frame::PostSettings& s) { s.ssao = true; },
            {"sample grid", "grid B", "max depth"},
            {"ssao"},
            {"upsample"}};
}

Subject dofSubject() {
    return {"dof",
            [](frame::PostSettings& s) {
                if (!s.dof) s.dof = post::DofOptions{.full = 0};
            },
            {"sample grid", "grid B"},
            {"dof"},
            {"dof combine"}};
}

double sumOf(const gpu::FrameTimes& times, const std::vector<std::string_view>& names) {
    double ms = 0;
    for (const gpu::PassTime& pass : times.passes)
        if (std::find(names.begin(), names.end(), pass.name) != names.end()) ms += pass.ms;
    return ms;
}

struct Measured {
    std::unique_ptr<frame::Frame> frame;
    std::vector<double> capture, rebuild, inputs, effect, combine;
    quality::RgbImage picture;

    void add(const gpu::FrameTimes& times, const Subject& subject) {
        capture.push_back(sumOf(times, {"capture", "capture rest"}));
        rebuild.push_back(sumOf(times, {"rebuild"}));
        inputs.push_back(sumOf(times, subject.inputs));
        effect.push_back(sumOf(times, subject.effect));
        combine.push_back(sumOf(times, subject.combine));
    }
    double onB() const { return median(inputs) + median(effect); }
    double total() const { return onB() + median(combine); }
};

/// The thesis's base sizes as far as --size goes, and half the first where that is all (small ones
/// of quick runs have their own).
std::vector<vk::Extent2D> baseSizes(const BenchOptions& options) {
    std::vector<vk::Extent2D> sizes;
    if (options.view.size.width >= 480 && options.view.size.width < 960)
        sizes.push_back({240, 135});
    for (const vk::Extent2D size : {vk::Extent2D{480, 270}, {960, 540}, {1920, 1080}, {3840, 2160}})
        if (int(size.width) <= options.view.size.width) sizes.push_back(size);
    if (sizes.empty())
        sizes.push_back({std::uint32_t(std::max(options.view.size.width / 2, 1)),
                         std::uint32_t(std::max(options.view.size.height / 2, 1))});
    return sizes;
}

/// Pictures are no larger than UHD, unless such base sizes are asked for, nor than 16 times the
/// largest base.
std::uint32_t mostPixels(const BenchOptions& options) {
    const auto width = std::uint32_t(options.view.size.width);
    return width >= 3840 ? 16384 : std::clamp(4 * width, 640u, 3840u);
}

Result<void> measure(const OpenCase& open, const BenchCase& what, const Subject& subject,
                     vk::Extent2D base, std::uint32_t rate, const BenchOptions& options,
                     BenchResult& result) {
    const auto& [session, camera] = open;
    const auto side = std::uint32_t(std::lround(std::sqrt(double(rate))));
    const bool large = base.width * side >= 3000;
    const RoundsInSets rounds(options.rounds);
    frame::FrameSettings settings = options.settings;
    settings.size = vk::Extent2D{base.width * side, base.height * side};
    // The rest of the shading is the same for all and not what is timed.
    settings.shadowTaps = std::min(settings.shadowTaps, 3u);
    settings.skyViews = std::min(settings.skyViews, 4u);
    std::array<Measured, kMethods.size()> all;
    Progress bar(fmt::format("{} {}x{}, rate {}", subject.name, base.width, base.height, rate),
                 std::size_t(rounds.count()));
    for (int round = 0; round < rounds.count(); ++round) {
        const bool opens = RoundsInSets::opensSet(round);
        if (opens)
            for (Measured& one : all) one.frame.reset();
        if (RoundsInSets::opensSet(round - 1))
            warmUp([&] { return all[0].frame->render(camera, {}); });
        for (std::size_t i = 0; i < kMethods.size(); ++i) {
            Measured& one = all[i];
            // Full rate is there to judge by: at UHD it takes gigabytes.
            if (kMethods[i].fullRate && (round > 0 || (large && rate == 64))) continue;
            if (!one.frame) {
                subject.enable(settings.post);
                settings.post.downsampled = kMethods[i].downsampled;
                settings.post.bilateral = kMethods[i].bilateral;
                one.frame =
                    std::make_unique<frame::Frame>(*session.device, *session.gpuScene, settings);
            }
            const std::uint32_t used = kMethods[i].fullRate ? 1 : rate;
            const auto times = one.frame->render(camera, {.postRates = {used, used, used}});
            settings.exposure = one.frame->settings().exposure;  // metered once
            if (!opens) one.add(times, subject);
            if (round == 0) one.picture = readDisplay(*session.device, *one.frame);
            if (kMethods[i].fullRate) one.frame.reset();
        }
        bar.update(std::size_t(round + 1));
    }
    bar.erase();
    const quality::RgbImage& reference = all[kReference].picture;
    for (std::size_t i = 0; i < kFull; ++i) {
        const Measured& one = all[i];
        Json row{{"measures", subject.name},
                 {"scene", fs::path(what.scene).filename().string()},
                 {"camera", what.camera},
                 {"width", settings.size.width},
                 {"height", settings.size.height},
                 {"size", fmt::format("{}x{}", base.width, base.height)},
                 {"rate", rate},
                 {"method", kMethods[i].name},
                 {"rounds", options.rounds}};
        row["capture_ms"] = median(one.capture);
        row["rebuild_ms"] = median(one.rebuild);
        row["inputs_ms"] = median(one.inputs);
        row["effect_ms"] = median(one.effect);
        row["combine_ms"] = median(one.combine);
        row["on_b_ms"] = one.onB();
        row["total_ms"] = one.total();
        row["on_b_of_reference"] = one.onB() / all[kReference].onB();
        row["total_of_reference"] = one.total() / all[kReference].total();
        const QualityFigures q = qualityOf(reference, one.picture);
        row["psnr_db"] = finiteOrNull(q.psnrDb);
        row["ssim"] = finiteOrNull(q.ssim);
        const quality::RgbImage& full = all[kFull].picture;
        row["full_rate_psnr_db"] =
            full.rgb.empty() ? Json() : finiteOrNull(quality::psnr(full, one.picture));
        result.rows.push_back(row);
        const fs::path file =
            options.out / fmt::format("{}-{}-{}-{}x{}-{}.png", subject.name, sceneSlug(what.scene),
                                      i == 0   ? "effective"
                                      : i == 1 ? "linear"
                                               : "reference",
                                      base.width, base.height, rate);
        if (i != 1) {
            if (auto done = writePng(file, one.picture); !done) return done;
            result.files.push_back(file);
        }
    }
    if (auto done = options.rowsCame(result); !done) return done;
    return validationVerdict(*session.device);
}

Result<BenchResult> runSubject(const Subject& subject, const std::vector<BenchCase>& defaults,
                               const BenchOptions& options) {
    const auto cases = benchCases(options, defaults);
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    for (const BenchCase& one : *cases) {
        const auto open = openCase(one, options);
        if (!open) return tl::unexpected(open.error());
        if (!result.report.device) describeDevice(open->session, result.report);
        for (const vk::Extent2D base : baseSizes(options))
            for (const std::uint32_t rate : kRates) {
                const auto side = std::uint32_t(std::lround(std::sqrt(double(rate))));
                if (base.width * side > mostPixels(options)) continue;
                if (auto done = measure(*open, one, subject, base, rate, options, result); !done)
                    return tl::unexpected(done.error());
            }
    }
    return result;
}

std::string placeOf(const Json& row) {
    return fmt::format(": {}, {} at {}", row.at("scene").get<std::string>(),
                       row.at("size").get<std::string>(), row.at("rate").dump());
}

void addPsnrBar(const Json& row, std::vector<Bar>& bars) {
    const double psnr = numberOrInfinity(row, "psnr_db");
    bars.push_back(
        {fmt::format("{} {} against its reference", row.at("measures").get<std::string>(),
                     row.at("method").get<std::string>()) +
             placeOf(row),
         psnr, "dB", ">= 40", psnr >= 40});
}

std::vector<Bar> ssaoBars(const Json& rows) {
    std::vector<Bar> bars;
    std::uint32_t most = 0;
    for (const Json& row : rows) most = std::max(most, row.at("rate").get<std::uint32_t>());
    for (const Json& row : rows) {
        if (row.at("method") != "effective") continue;
        addPsnrBar(row, bars);
        if (row.at("rate").get<std::uint32_t>() != most) continue;
        const double times = row.at("on_b_of_reference");
        bars.push_back({"ssao / reference, depth and effect" + placeOf(row), times, "x", "<= 0.6",
                        times <= 0.6});
    }
    return bars;
}

std::vector<Bar> dofBars(const Json& rows) {
    std::vector<Bar> bars;
    int most = 0;
    for (const Json& row : rows) most = std::max(most, row.at("width").get<int>());
    for (const Json& row : rows) {
        if (row.at("method") != "effective") continue;
        addPsnrBar(row, bars);
        if (row.at("width").get<int>() != most) continue;
        const double times = row.at("total_of_reference");
        bars.push_back(
            {"dof / reference, all of it" + placeOf(row), times, "x", "<= 0.9", times <= 0.9});
    }
    return bars;
}

Result<BenchResult> runSsao(const BenchOptions& options) {
    return runSubject(ssaoSubject(),
                      {{"sponza.glb", "nave", ""}, {"city_kaykit.glb", "street", ""}}, options);
}

Result<BenchResult> runDof(const BenchOptions& options) {
    auto result = runSubject(dofSubject(),
                             {{"chess_abeautifulgame.glb", "pieces", ""},
                              {"sponza.glb", "nave", ""},
                              {"city_kaykit.glb", "street", ""}},
                             options);
    if (result)
        result->source =
            Json::array({{{"source", "thesis, §5.2.1 (RTX 3090)"},
                          {"psnr_db", published("thesis_dof").at("mean_psnr_db")},
                          {"ms_against_ref", published("thesis_dof").at("ms_against_ref")}}});
    return result;
}

const std::vector<std::string> kColumns{"scene",
                                        "size",
                                        "rate",
                                        "method",
                                        "capture_ms",
                                        "rebuild_ms",
                                        "inputs_ms",
                                        "effect_ms",
                                        "combine_ms",
                                        "on_b_of_reference",
                                        "total_of_reference",
                                        "psnr_db",
                                        "ssim",
                                        "full_rate_psnr_db"};

constexpr Scope kOnCpu{{480, 270}, 3, 0}, kOnGpu{{1920, 1080}, 9, 0};

}  // namespace

Bench ssaoBench() {
    return {.name = "ssao",
            .what = "ambient occlusion at effective resolution against downsampled inputs",
            .run = runSsao,
            .bars = ssaoBars,
            .tables = {{"ssao", kColumns}},
            .onCpu = kOnCpu,
            .onGpu = kOnGpu};
}

Bench dofBench() {
    return {.name = "dof",
            .what = "depth of field at effective resolution against downsampled inputs",
            .run = runDof,
            .bars = dofBars,
            .tables = {{"dof", kColumns}},
            .onCpu = kOnCpu,
            .onGpu = kOnGpu};
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/visibility_cases.hpp"
#include "app/capture.hpp"
#include "app/console.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

using budget::median;
using frame::CaptureBackend;

constexpr std::uint32_t kSide = 4;  // the thesis's 16 samples a pixel
constexpr int kWarmUp = 1;

/// Times of one renderer, round by round: everything up to shading, and shading.
struct Times {
    std::vector<double> sampling, shading;
    std::map<std::string, std::vector<double>> passes;

    void add(const gpu::FrameTimes& times) {
        std::map<std::string, double> sums;
        for (const gpu::PassTime& pass : times.passes) sums[pass.name] += pass.ms;
        double sample = 0;
        for (const auto& [name, ms] : sums) {
            passes[name].push_back(ms);
            if (name != "shade") sample += ms;
        }
        sampling.push_back(sample);
        shading.push_back(sums["shade"]);
    }
    double total() const { return median(sampling) + median(shading); }
    void write(Json& row) const {
        row["rounds"] = sampling.size();
        row["sampling_ms"] = median(sampling);
        row["shading_ms"] = median(shading);
        row["total_ms"] = total();
        for (const auto& [name, ms] : passes) row[name + "_pass_ms"] = median(ms);
    }
};

Result<void> measure(const VisibilitySubject& subject, const NamedSize& size,
                     const BenchOptions& options, BenchResult& result) {
    const gpu::Device& device = *subject.session.device;
    const scene::GpuScene& scene = *subject.session.gpuScene;
    const vk::Extent2D base{size.width / kSide, size.height / kSide};
    const float aspect = static_cast<float>(base.width) / static_cast<float>(base.height);
    DeferredReference reference(device, scene, {base.width * kSide, base.height * kSide});
    std::vector<std::pair<std::string, std::unique_ptr<RecordRenderer>>> ours;
    for (const CaptureBackend backend :
         {CaptureBackend::compute, CaptureBackend::supersample, CaptureBackend::multisample}) {
        if (backend == CaptureBackend::compute && !device.hasInt64Atomics()) continue;
        if (backend == CaptureBackend::multisample && device.multisamples() < 4) continue;
        ours.emplace_back(
            nameOf(backend),
            std::make_unique<RecordRenderer>(
                device, scene,
                frame::CaptureSettings{.base = base, .side = kSide, .backend = backend}));
    }
    std::vector<Times> times(ours.size());
    Times referenceTimes;
    const int rounds = size.width > 3840 ? std::min(options.rounds, 3) : options.rounds;
    Progress bar(fmt::format("{} {}", subject.name, size.name),
                 static_cast<std::size_t>(rounds + kWarmUp));
    warmUp([&] { return reference.render(subject.camera, aspect); });
    for (int round = -kWarmUp; round < rounds; ++round) {
        for (std::size_t i = 0; i < ours.size(); ++i) {
            const gpu::FrameTimes t = ours[i].second->render(subject.camera, aspect);
            if (round >= 0) times[i].add(t);
        }
        const gpu::FrameTimes t = reference.render(subject.camera, aspect);
        if (round >= 0) referenceTimes.add(t);
        bar.update(static_cast<std::size_t>(round + kWarmUp + 1));
    }
    bar.erase();
    const std::string automatic =
        nameOf(frame::chooseBackend(device, scene, {.base = base, .side = kSide}, subject.camera));
    for (std::size_t i = 0; i < ours.size(); ++i) {
        Json row = visibilityRow("time", subject, size, ours[i].first, kSide);
        times[i].write(row);
        row["of_ref"] = times[i].total() / referenceTimes.total();
        row["automatic"] = ours[i].first == automatic;
        result.rows.push_back(row);
    }
    Json row = visibilityRow("time", subject, size, "ref", 1);
    referenceTimes.write(row);
    row["of_ref"] = 1.0;
    row["automatic"] = false;
    result.rows.push_back(row);
    return validationVerdict(device);
}

Json publishedRows() {
    const Json& table = thesis().at("thesis_table4_ms_sampling_shading");
    Json rows = Json::array();
    for (const char* triangles : {"260k", "1M", "10M", "100M"})
        for (const auto& [method, cells] : table.at(triangles).items())
            for (std::size_t i = 0; i < cells.size(); ++i) {
                const Json& reference = table.at(triangles).at("ref")[i];
                const double ours = cells[i][0].get<double>() + cells[i][1].get<double>();
                rows.push_back(
                    {{"source", "thesis, table 4 (RTX 3090)"},
                     {"triangles", triangles},
                     {"size", table.at("columns")[i]},
                     {"method", method},
                     {"sampling_ms", cells[i][0]},
                     {"shading_ms", cells[i][1]},
                     {"of_ref", ours / (reference[0].get<double>() + reference[1].get<double>())}});
            }
    return rows;
}

Result<BenchResult> run(const BenchOptions& options) {
    auto cases = benchCases(options, {{"sponza.glb", "nave", ""}});
    if (!cases) return tl::unexpected(cases.error());
    if (options.scene.empty()) {
        cases->push_back({"builtin:grid:1000000", "above", ""});
        cases->push_back({"builtin:grid:10000000", "above", ""});
    }
    BenchResult result;
    for (const BenchCase& one : *cases) {
        auto subject = openSubject(one, options);
        if (!subject) return tl::unexpected(subject.error());
        const auto sizes = sizesUpTo(options, "8K");
        for (const NamedSize& size : sizes) {
            if (size.width < 1920 && sizes.size() > 1) continue;  // the thesis starts at FHD
            if (auto done = measure(*subject, size, options, result); !done)
                return tl::unexpected(done.error());
        }
        if (!result.report.device) {
            describeDevice(subject->session, result.report);
            result.report.counts = {{"triangles_total", subject->triangles}};
        }
    }
    result.source = publishedRows();
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        if (!row.at("automatic").get<bool>()) continue;
        if (row.at("size") != "UHD" && row.at("width").get<int>() >= 640) continue;
        const double goal = row.at("triangles").get<std::uint64_t>() > 5'000'000 ? 0.7 : 0.9;
        const double value = row.at("of_ref").get<double>();
        bars.push_back(
            {fmt::format("(sampling + shading) / REF: {} {}, {}",
                         row.at("scene").get<std::string>(), row.at("size").get<std::string>(),
                         row.at("method").get<std::string>()),
             value, "x", fmt::format("<= {}", goal), value <= goal});
    }
    return bars;
}

}  // namespace

Bench visibilityTimeBench() {
    return {
        .name = "visibility-time",
        .what = "capture, compaction and shading by each backend against deferred shading",
        .run = run,
        .bars = barsOf,
        .tables = {{"time",
                    {"scene", "size", "method", "sampling_ms", "shading_ms", "total_ms", "of_ref",
                     "cull_pass_ms", "capture_pass_ms", "compact_pass_ms", "gbuffer_pass_ms"}}}};
}

}  // namespace lodestar::app

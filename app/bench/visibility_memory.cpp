// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <lodestar/visibility/stream.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/visibility_cases.hpp"
#include "app/capture.hpp"
#include "app/console.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

constexpr std::uint32_t kSide = 8;  // the thesis's 1/64 compaction

Result<void> measure(const VisibilitySubject& subject, const NamedSize& size, const BenchOptions&,
                     BenchResult& result) {
    const gpu::Device& device = *subject.session.device;
    const vk::Extent2D base{size.width / kSide, size.height / kSide};
    frame::CaptureSettings settings{.base = base, .side = kSide};
    settings.backend =
        frame::chooseBackend(device, *subject.session.gpuScene, settings, subject.camera);
    frame::CaptureFrame capture(device, *subject.session.gpuScene, settings);
    capture.capture(subject.camera);
    visibility::Stream stream{.record = visibility::readRecord(device, capture.compact()),
                              .camera = subject.camera,
                              .scene = subject.name};
    const auto bytes = visibility::bytesOf(stream.record);
    const auto file = visibility::encodeStream(stream).size();
    const auto plain = visibility::encodeStream(stream, {.predictIds = false}).size();
    const std::uint64_t pixels = std::uint64_t{size.width} * size.height;
    Json row = visibilityRow("memory", subject, size, nameOf(capture.backend()), kSide);
    row["heads_bytes"] = bytes.heads;
    row["list_bytes"] = bytes.lists;
    row["nodes"] = stream.record.nodes.size();
    row["mixed_share"] = share(bytes.mixedPixels, stream.record.heads.size());
    row["total_bytes"] = bytes.total();
    row["thesis_nodes"] = stream.record.nodes.size() + bytes.mixedPixels;
    row["thesis_layout_bytes"] = bytes.thesisTotal();
    row["of_thesis_share"] = share(bytes.total(), bytes.thesisTotal());
    row["lvis_bytes"] = file;
    row["lvis_of_thesis_share"] = share(file, bytes.thesisTotal());
    row["lvis_unpredicted_ids_bytes"] = plain;
    row["ref_bytes"] = 16 * pixels;
    row["of_ref_share"] = share(bytes.total(), 16 * pixels);
    row["transient_bytes"] = capture.transientBytes();
    row["bands"] = capture.bands();
    result.rows.push_back(row);
    return validationVerdict(device);
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = visibilityCases(options);
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    for (const BenchCase& one : *cases) {
        auto subject = openSubject(one, options);
        if (!subject) return tl::unexpected(subject.error());
        const auto sizes = sizesUpTo(options, "16K");
        for (const NamedSize& size : sizes) {
            if (size.width < 3840 && sizes.size() > 1) continue;  // the thesis starts at UHD
            if (auto done = measure(*subject, size, options, result); !done)
                return tl::unexpected(done.error());
        }
        if (!result.report.device) {
            describeDevice(subject->session, result.report);
            result.report.counts = {{"triangles_total", subject->triangles}};
        }
    }
    const Json& table = thesis().at("thesis_table3_memory_mb");
    for (const char* scene : {"RB", "RC", "SP", "WT"})
        for (const auto& [size, figures] : table.at(scene).items()) {
            Json row{{"source", "thesis, table 3"}, {"scene", scene}, {"size", size}};
            for (std::size_t i = 0; i < figures.size(); ++i)
                row[table.at("columns")[i].get<std::string>() + "_mb"] = figures[i];
            row["triangles"] = thesis().at("thesis_triangles").at(scene);
            result.source.push_back(row);
        }
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        const std::string place = fmt::format("{} {}", row.at("scene").get<std::string>(),
                                              row.at("size").get<std::string>());
        const double memory = 100 * row.at("of_thesis_share").get<double>();
        bars.push_back(
            {"in memory, of the thesis's layout: " + place, memory, "%", "<= 60", memory <= 60});
        const double file = 100 * row.at("lvis_of_thesis_share").get<double>();
        bars.push_back({".lvis, of the thesis's layout: " + place, file, "%", "<= 20", file <= 20});
        if (row.at("size") != "16K") continue;
        const double peak = row.at("transient_bytes").get<double>() / 1e6;
        bars.push_back({"transient peak: " + place, peak, "MB", "<= 300", peak <= 300});
    }
    return bars;
}

}  // namespace

Bench visibilityMemoryBench() {
    return {.name = "visibility-memory",
            .what =
                "bytes of compact visibility: heads, lists, streams, against the thesis and a "
                "G-buffer",
            .run = run,
            .bars = barsOf,
            .tables = {{"memory",
                        {"scene", "size", "heads_bytes", "list_bytes", "nodes", "mixed_share",
                         "total_bytes", "thesis_layout_bytes", "of_thesis_share", "lvis_bytes",
                         "lvis_of_thesis_share", "lvis_unpredicted_ids_bytes", "ref_bytes",
                         "of_ref_share", "transient_bytes"}}}};
}

}  // namespace lodestar::app

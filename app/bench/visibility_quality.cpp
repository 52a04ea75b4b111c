// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include <lodestar/shared/octahedral.h>
#include <lodestar/budget/trace.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>
#include <lodestar/visibility/expand.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/visibility_cases.hpp"
#include "app/capture.hpp"
#include "app/console.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

using frame::CaptureBackend;

/// PSNR of values 0 … 1 [dB].
class Error {
public:
    void add(double difference) {
        sum += difference * difference;
        ++count;
    }
    double psnr() const {
        return sum > 0 ? 10 * std::log10(static_cast<double>(count) / sum)
                       : std::numeric_limits<double>::infinity();
    }

private:
    double sum = 0;
    std::size_t count = 0;
};

/// RGB of rgba, cropped to `size`.
quality::RgbImage pictureOf(const std::vector<std::uint8_t>& rgba, vk::Extent2D size) {
    quality::RgbImage picture(static_cast<int>(size.width), static_cast<int>(size.height));
    for (std::size_t i = 0; i < picture.rgb.size(); ++i) picture.rgb[i] = rgba[i / 3 * 4 + i % 3];
    return picture;
}

/// A normal as 8-bit codes, as pictures of normals are compared.
quality::RgbImage normalPicture(const Attributes& a) {
    quality::RgbImage picture(static_cast<int>(a.size.width), static_cast<int>(a.size.height));
    for (std::size_t i = 0; i < a.normals.size(); ++i) {
        if (a.ids[i] == 0) continue;
        const glm::vec3 n = shared::unpackNormal(a.normals[i]);
        for (int c = 0; c < 3; ++c)
            picture.rgb[3 * i + static_cast<std::size_t>(c)] =
                static_cast<std::uint8_t>(std::lround((n[c] * 0.5f + 0.5f) * 255));
    }
    return picture;
}

void addAttributeFigures(Json& row, const Attributes& reference, const Attributes& test) {
    const auto pictures = [&](const char* what, const quality::RgbImage& a,
                              const quality::RgbImage& b) {
        row[std::string(what) + "_psnr_db"] = finiteOrNull(quality::psnr(a, b));
        // SSIM holds several floating-point planes: not for the largest pictures.
        if (a.width >= 11 && a.height >= 11 && a.width <= 3840)
            row[std::string(what) + "_ssim"] = quality::ssim(a, b);
    };
    pictures("albedo", pictureOf(reference.albedo, reference.size),
             pictureOf(test.albedo, test.size));
    pictures("normal", normalPicture(reference), normalPicture(test));
    pictures("shading", pictureOf(reference.color, reference.size),
             pictureOf(test.color, test.size));
    const float farthest = *std::max_element(reference.depth.begin(), reference.depth.end());
    Error depth;
    std::size_t same = 0;
    for (std::size_t i = 0; i < reference.ids.size(); ++i) {
        depth.add((test.depth[i] - reference.depth[i]) / std::max(farthest, 1e-30f));
        same += reference.ids[i] == test.ids[i];
    }
    row["depth_psnr_db"] = finiteOrNull(depth.psnr());
    row["same_ids_of_ref_share"] = share(same, reference.ids.size());
}

std::size_t sameIds(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    std::size_t same = 0;
    for (std::size_t i = 0; i < a.size(); ++i) same += a[i] == b[i];
    return same;
}

/// A backend's own direct raster: ids at `size`, one sample a pixel. `bandRows` of it at a time, as
/// what it is compared with was captured; 0 = as many as fit.
std::vector<std::uint32_t> directIds(const VisibilitySubject& subject, vk::Extent2D size,
                                     CaptureBackend backend, std::uint32_t bandRows = 0) {
    frame::CaptureFrame capture(
        *subject.session.device, *subject.session.gpuScene,
        {.base = size, .side = 1, .backend = backend, .bandRows = bandRows});
    capture.capture(subject.camera);
    return visibility::expandReference(
        visibility::readRecord(*subject.session.device, capture.compact()));
}

/// Attributes and shading from the record, at its capture rate, against REF at the same size.
Result<void> measureAttributes(const VisibilitySubject& subject, const NamedSize& size,
                               const BenchOptions& options, BenchResult& result) {
    const gpu::Device& device = *subject.session.device;
    const scene::GpuScene& scene = *subject.session.gpuScene;
    const vk::Extent2D extent{size.width / 8 * 8, size.height / 8 * 8};
    const float aspect = static_cast<float>(extent.width) / static_cast<float>(extent.height);
    Attributes reference;
    {
        DeferredReference renderer(device, scene, extent);
        renderer.render(subject.camera, aspect);
        reference = renderer.read();
    }
    struct Case {
        CaptureBackend backend;
        std::uint32_t side;
    };
    std::vector<Case> cases{{CaptureBackend::supersample, 8}};
    if (device.hasInt64Atomics()) cases.push_back({CaptureBackend::compute, 8});
    for (const std::uint32_t side : {4u, 8u})
        if (!visibility::planMultisample(device.multisamples(), side).shifts.empty())
            cases.push_back({CaptureBackend::multisample, side});
    for (const auto& [backend, side] : cases) {
        const vk::Extent2D base{extent.width / side, extent.height / side};
        RecordRenderer ours(device, scene, {.base = base, .side = side, .backend = backend});
        const Attributes found = ours.read(subject.camera, aspect);
        Json row = visibilityRow("attributes", subject, size, nameOf(backend), side);
        addAttributeFigures(row, reference, found);
        // Multisampling has no direct raster; it is held against supersampling.
        const CaptureBackend direct =
            backend == CaptureBackend::multisample ? CaptureBackend::supersample : backend;
        row["same_ids_of_direct_share"] =
            share(sameIds(found.ids,
                          directIds(subject, extent, direct, side * ours.capture().rowsOfBand())),
                  found.ids.size());
        result.rows.push_back(row);
        if (backend == CaptureBackend::supersample && extent.width <= 3840) {
            const auto stem = options.out / fmt::format("visibility-quality.{}.{}",
                                                        sceneSlug(subject.name), size.width);
            const std::filesystem::path mine = stem.string() + ".rebuilt.png",
                                        theirs = stem.string() + ".ref.png";
            result.files.insert(result.files.end(), {mine, theirs});
            if (auto done = writePng(mine, pictureOf(found.color, extent)); !done) return done;
            if (auto done = writePng(theirs, pictureOf(reference.color, extent)); !done)
                return done;
        }
    }
    return validationVerdict(device);
}

/// Ids at twice the capture's size from 16 samples a pixel, against raster at that size.
Result<void> measureUpscale(const VisibilitySubject& subject, const NamedSize& size,
                            BenchResult& result) {
    const gpu::Device& device = *subject.session.device;
    const vk::Extent2D base{size.width / 8, size.height / 8};
    const vk::Extent2D out{base.width * 8, base.height * 8};
    frame::CaptureFrame capture(device, *subject.session.gpuScene, {.base = base, .side = 4});
    capture.capture(subject.camera);
    const visibility::Expand expand(device, 4);
    const gpu::Image ids(
        device, {.name = "ids",
                 .format = vk::Format::eR32Uint,
                 .extent = out,
                 .usage = vk::ImageUsageFlagBits::eStorage | vk::ImageUsageFlagBits::eTransferSrc});
    const float aspect = static_cast<float>(base.width) / static_cast<float>(base.height);
    gpu::Recorder rec(device);
    rec.begin();
    expand.record(rec, *subject.session.gpuScene, capture.compact(),
                  subject.camera.clipFromView(aspect) * subject.camera.viewFromWorld(), ids);
    rec.submit();
    const auto found = gpu::as<std::uint32_t>(gpu::readImage(device, ids));
    const auto direct = directIds(subject, out, capture.backend());
    const auto record =
        visibility::expandReference(visibility::readRecord(device, capture.compact()));
    std::size_t nearest = 0;
    for (std::uint32_t y = 0; y < out.height; ++y)
        for (std::uint32_t x = 0; x < out.width; ++x)
            nearest += record[std::size_t{y / 2} * (out.width / 2) + x / 2] ==
                       direct[std::size_t{y} * out.width + x];
    Json row = visibilityRow("upscale", subject, size, nameOf(capture.backend()), 4);
    row["same_ids_share"] = share(sameIds(found, direct), found.size());
    row["same_ids_by_nearest_sample_share"] = share(nearest, found.size());
    result.rows.push_back(row);
    return validationVerdict(device);
}

/// Linear radiance of a frame, tone-mapped and encoded after averaging n × n pixels.
quality::RgbImage averaged(const gpu::Device& device, const gpu::View& radiance, std::uint32_t n,
                           float exposure) {
    const auto halves = gpu::as<std::uint64_t>(gpu::readImage(device, radiance));
    const vk::Extent2D size{radiance.extent.width / n, radiance.extent.height / n};
    std::vector<glm::vec3> sums(std::size_t{size.width} * size.height);
    for (std::size_t i = 0; i < halves.size(); ++i) {
        const std::size_t x = i % radiance.extent.width, y = i / radiance.extent.width;
        sums[y / n * size.width + x / n] += glm::vec3(glm::unpackHalf4x16(halves[i]));
    }
    quality::RgbImage picture(static_cast<int>(size.width), static_cast<int>(size.height));
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const glm::vec3 c = sums[i] * (exposure / static_cast<float>(n * n));
        for (int k = 0; k < 3; ++k) {
            const float mapped = c[k] / (1 + c[k]);
            const float code = mapped <= 0.0031308f ? 12.92f * mapped
                                                    : 1.055f * std::pow(mapped, 1 / 2.4f) - 0.055f;
            picture.rgb[3 * i + static_cast<std::size_t>(k)] =
                static_cast<std::uint8_t>(std::lround(255 * glm::clamp(code, 0.0f, 1.0f)));
        }
    }
    return picture;
}

/// Anti-aliased output against shading every one of 64 samples; and what it costs over none.
Result<void> measureAntialiasing(const VisibilitySubject& subject, const NamedSize& size,
                                 const BenchOptions& options, BenchResult& result) {
    const gpu::Device& device = *subject.session.device;
    const scene::GpuScene& scene = *subject.session.gpuScene;
    constexpr std::uint32_t kSide = 8;
    const vk::Extent2D base{size.width / kSide, size.height / kSide};
    frame::FrameSettings settings = options.settings;
    settings.size = vk::Extent2D{base.width * kSide, base.height * kSide};
    quality::RgbImage expected;
    {
        frame::Frame fine(device, scene, settings);
        fine.render(subject.camera, {});
        settings.exposure = fine.settings().exposure;  // metered, when it was left to the frame
        expected = averaged(device, fine.radiance(), kSide, settings.exposure);
    }
    settings.size = base;
    frame::Frame frame(device, scene, settings);
    frame::CaptureFrame capture(device, scene, {.base = base, .side = kSide});
    capture.capture(subject.camera);
    const auto shadingMs = [](const gpu::FrameTimes& times) {
        double ms = 0;
        for (const gpu::PassTime& pass : times.passes)
            if (pass.name != "cull" && pass.name != "capture" && pass.name != "shadow map" &&
                pass.name != "expand")
                ms += pass.ms;
        return ms;
    };
    std::vector<double> plainMs, smoothMs;
    quality::RgbImage plain, smooth;
    for (int round = -1; round < options.rounds; ++round) {
        const auto a = frame.rebuild(capture.compact(), subject.camera, {});
        if (round < 0) plain = averaged(device, frame.radiance(), 1, settings.exposure);
        const auto b = frame.rebuildAntialiased(capture.compact(), subject.camera);
        if (round < 0) smooth = averaged(device, frame.radiance(), 1, settings.exposure);
        if (round < 0) continue;
        plainMs.push_back(shadingMs(a));
        smoothMs.push_back(shadingMs(b));
    }
    Json row = visibilityRow("antialiasing", subject, size, nameOf(capture.backend()), kSide);
    row["psnr_db"] = finiteOrNull(quality::psnr(expected, smooth));
    row["plain_psnr_db"] = finiteOrNull(quality::psnr(expected, plain));
    row["fragments_a_pixel"] =
        1 + static_cast<double>(frame.furtherFragments()) / (double(base.width) * base.height);
    row["plain_ms"] = budget::median(plainMs);
    row["smooth_ms"] = budget::median(smoothMs);
    row["cost"] = budget::median(smoothMs) / budget::median(plainMs);
    result.rows.push_back(row);
    for (const auto& [name, picture] :
         {std::pair{"aa", &smooth}, {"aa-plain", &plain}, {"aa-64x", &expected}}) {
        const auto file = options.out / fmt::format("visibility-quality.{}.{}.png",
                                                    sceneSlug(subject.name), name);
        result.files.push_back(file);
        if (auto done = writePng(file, *picture); !done) return done;
    }
    return validationVerdict(device);
}

Json publishedRows() {
    Json rows = Json::array();
    const Json& ms = thesis().at("thesis_table1_ms_vs_ref");
    for (const auto& [scene, rates] : ms.at("psnr_db_ssim").items())
        for (const auto& [rate, cells] : rates.items()) {
            Json row{{"source", "thesis, table 1"},
                     {"scene", scene},
                     {"method", "ms"},
                     {"base", ms.at("base")},
                     {"capture_rate", std::stoi(rate)}};
            for (std::size_t i = 0; i < cells.size(); ++i) {
                const auto what = ms.at("columns")[i].get<std::string>();
                row[what + "_psnr_db"] = cells[i][0];
                row[what + "_ssim"] = cells[i][1];
            }
            rows.push_back(row);
        }
    const Json& ss = thesis().at("thesis_table2_ss_vs_ref_psnr_db");
    for (const auto& [scene, attributes] : ss.items()) {
        if (scene == "columns") continue;
        for (std::size_t i = 0; i < ss.at("columns").size(); ++i) {
            Json row{{"source", "thesis, table 2"},
                     {"scene", scene},
                     {"method", "ss"},
                     {"size", ss.at("columns")[i]}};
            for (const auto& [what, values] : attributes.items())
                row[what + "_psnr_db"] = values[i];
            rows.push_back(row);
        }
    }
    return rows;
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = visibilityCases(options);
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    for (const BenchCase& one : *cases) {
        auto subject = openSubject(one, options);
        if (!subject) return tl::unexpected(subject.error());
        const auto sizes = sizesUpTo(options, "8K");
        for (const NamedSize& size : sizes)
            if (auto done = measureAttributes(*subject, size, options, result); !done)
                return tl::unexpected(done.error());
        // Twice the size of FHD captured at 16 samples is UHD; 64 samples of FHD/2 are UHD too.
        const NamedSize& middle = sizes[std::min<std::size_t>(2, sizes.size() - 1)];
        if (auto done = measureUpscale(*subject, middle, result); !done)
            return tl::unexpected(done.error());
        if (auto done = measureAntialiasing(*subject, sizes.back(), options, result); !done)
            return tl::unexpected(done.error());
        if (!result.report.device) {
            describeDevice(subject->session, result.report);
            result.report.counts = {{"triangles_total", subject->triangles}};
        }
    }
    result.source = publishedRows();
    return result;
}

/// What is finer than a picture's pixels cannot be known between its samples, nor shaded once a
/// pixel: some bars are for scenes of a few hundred thousand to a few million triangles.
bool isSponzaClass(const Json& row) {
    return row.at("triangles").get<double>() < 5e6;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    const auto atLeast = [&](const std::string& what, double value, const char* unit, double goal) {
        bars.push_back({what, value, unit, fmt::format(">= {:g}", goal), value >= goal});
    };
    for (const Json& row : rows) {
        const std::string place = fmt::format(
            "{} {} {} at {}", row.at("scene").get<std::string>(), row.at("size").get<std::string>(),
            row.at("method").get<std::string>(), row.at("capture_rate").get<int>());
        if (row.at("measures") == "attributes") {
            const double ids = 100 * row.at("same_ids_of_direct_share").get<double>();
            if (row.at("method") == "ms") {
                atLeast("ids of supersampling: " + place, ids, "%", 99.8);
                atLeast("shading: " + place, numberOrInfinity(row, "shading_psnr_db"), "dB", 45);
                continue;
            }
            atLeast("ids of direct raster: " + place, ids, "%", 100);
            if (row.at("method") != "ss") continue;
            for (const char* what : {"albedo", "normal"})
                atLeast(fmt::format("{}: {}", what, place),
                        numberOrInfinity(row, fmt::format("{}_psnr_db", what).c_str()), "dB", 60);
            atLeast("depth: " + place, numberOrInfinity(row, "depth_psnr_db"), "dB", 90);
        } else if (row.at("measures") == "upscale") {
            if (isSponzaClass(row))
                atLeast("ids at twice the capture's size: " + place,
                        100 * row.at("same_ids_share").get<double>(), "%", 99);
        } else {
            atLeast("anti-aliased, against 64 shaded samples: " + place,
                    numberOrInfinity(row, "psnr_db"), "dB", 40);
            const double cost = row.at("cost").get<double>();
            if (isSponzaClass(row))
                bars.push_back({"anti-aliased shading over plain: " + place, cost, "x", "<= 1.4",
                                cost <= 1.4});
        }
    }
    return bars;
}

}  // namespace

Bench visibilityQualityBench() {
    return {.name = "visibility-quality",
            .what =
                "ids, attributes, shading and anti-aliasing from visibility against direct "
                "rendering",
            .run = run,
            .bars = barsOf,
            .tables = {
                {"attributes",
                 {"scene", "size", "method", "capture_rate", "albedo_psnr_db", "normal_psnr_db",
                  "depth_psnr_db", "shading_psnr_db", "same_ids_of_ref_share",
                  "same_ids_of_direct_share"}},
                {"upscale",
                 {"scene", "size", "method", "same_ids_share", "same_ids_by_nearest_sample_share"}},
                {"antialiasing",
                 {"scene", "size", "psnr_db", "plain_psnr_db", "fragments_a_pixel", "plain_ms",
                  "smooth_ms", "cost"}}}};
}

}  // namespace lodestar::app

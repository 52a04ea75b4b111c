// SPDX-License-Identifier: Apache-2.0
#include "app/rebuild.hpp"

#include <cmath>
#include <fstream>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "app/bench/bench.hpp"
#include "app/capture.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"
#include "app/post_options.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMostFileBytes = 2ull << 30;

struct Options {
    std::string stream, scene;
    gpu::DeviceRequest device;
    std::optional<PictureSize> size;
    frame::FrameSettings settings;
    double shadingRate = 1;
    budget::Levers levers;  ///< the rates of effects
    bool antialias = false, reference = false;
    fs::path out, json;
};

Result<std::vector<std::byte>> readFile(const std::string& path) {
    std::error_code error;
    const auto size = fs::file_size(path, error);
    if (error) return fail(path + ": " + error.message() + "; name a .lvis file");
    if (size > kMostFileBytes) return fail(path + ": over 2 GiB; is it a .lvis file?");
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file) return fail(path + ": cannot be read; name a .lvis file");
    return bytes;
}

/// An error when the stream was not captured from this scene.
Result<void> checkScene(const Session& session, const visibility::Stream& stream,
                        const Options& options) {
    const auto refuse = [&](const std::string& what) {
        return fail(fmt::format("{}: {}", printable(options.stream), what));
    };
    if (stream.sceneHash != visibility::hashOf(*session.scene))
        return refuse(fmt::format(
            "captured from '{}', whose contents are not those of {}; give the scene it was "
            "captured from",
            printable(stream.scene), printable(options.scene)));
    if (stream.clusterHash != clusterHashOf(session))
        return refuse(
            "captured by a build that cuts this scene's meshes in another way; capture it again");
    if (auto known = checkIds(session, stream.record); !known) return refuse(known.error().message);
    return {};
}

vk::Extent2D outputSize(const Options& options, const visibility::Record& record) {
    if (options.size)
        return {static_cast<std::uint32_t>(options.size->width),
                static_cast<std::uint32_t>(options.size->height)};
    if (options.antialias) return {record.width, record.height};
    return {record.width * record.side, record.height * record.side};
}

Result<void> run(Options options) {
    if (options.settings.post.shutter > 0)
        return fail("--motion-blur: a stream has no frame before; leave it out");
    const auto bytes = readFile(options.stream);
    if (!bytes) return tl::unexpected(bytes.error());
    const auto stream = visibility::decodeStream(*bytes, printable(options.stream));
    if (!stream) return tl::unexpected(stream.error());
    const visibility::Record& record = stream->record;
    const vk::Extent2D size = outputSize(options, record);
    if (options.antialias && (size.width != record.width || size.height != record.height))
        return fail(fmt::format(
            "--antialias gives the base size of the capture: leave --size out, or give {}x{}",
            record.width, record.height));

    auto session = openSession(options.scene, options.device);
    if (!session) return tl::unexpected(session.error());
    if (auto same = checkScene(*session, *stream, options); !same) return same;
    if (session->gpuScene->animated()) session->gpuScene->animate(stream->seconds);
    fmt::print("{} at {}x{} on {}\n", printable(options.stream), size.width, size.height,
               session->device->description().name);
    const double stretch = static_cast<double>(size.width) / size.height / stream->aspect;
    if (std::abs(stretch - 1) > 0.01)
        fmt::print("note: {}x{} is not the shape of the capture: the picture is stretched\n",
                   size.width, size.height);

    options.settings.size = size;
    options.settings.aspect = stream->aspect;
    frame::Frame frame(*session->device, *session->gpuScene, options.settings);
    const visibility::CompactRecord onGpu = visibility::uploadRecord(*session->device, record);
    budget::Levers levers = options.levers;
    levers.shadingRate = static_cast<float>(options.shadingRate);
    const gpu::FrameTimes times = options.antialias
                                      ? frame.rebuildAntialiased(onGpu, stream->camera, levers)
                                      : frame.rebuild(onGpu, stream->camera, levers);
    const quality::RgbImage picture = readDisplay(*session->device, frame);
    if (auto written = writePng(options.out, picture); !written) return written;

    const std::uint32_t rate = record.samples();
    fmt::print("  rebuilt {}x{} from {}x{} at {} sample{} a pixel in {}\n", size.width, size.height,
               record.width, record.height, rate, rate == 1 ? "" : "s", formatMs(times.gpuMs));
    if (options.antialias)
        fmt::print("  {} fragments shaded beyond one a pixel\n",
                   formatCount(frame.furtherFragments()));
    std::optional<QualityFigures> quality;
    if (options.reference) {
        frame.render(stream->camera, levers);
        quality = qualityOf(readDisplay(*session->device, frame), picture);
        fmt::print("  against direct rendering at this size: {}\n",
                   std::isinf(quality->psnrDb)
                       ? "identical"
                       : fmt::format("PSNR {:.1f} dB, SSIM {:.4f}, FLIP {:.4f}", quality->psnrDb,
                                     quality->ssim, quality->flip));
    }
    if (!options.json.empty()) {
        Report report;
        describeDevice(*session, report);
        report.settings = settingsJson(options.settings);
        report.settings["shading_rate"] = options.shadingRate;
        report.settings["post_rates"] = postRatesJson(levers);
        report.settings["antialias"] = options.antialias;
        report.settings["capture_rate"] = rate;
        report.settings["capture_width"] = record.width;
        report.settings["capture_height"] = record.height;
        report.passes = summarisePasses({costsOf(times)});
        report.frameMs = times.gpuMs;
        report.quality = quality;
        report.counts = {{"list_nodes", record.nodes.size()},
                         {"mixed_pixels", visibility::bytesOf(record).mixedPixels},
                         {"triangles_total", session->gpuScene->triangleCount()}};
        report.more["stream"] = {{"file", options.stream}, {"file_bytes", bytes->size()}};
        if (auto written = writeJson(options.json, toJson(report)); !written) return written;
    }
    fmt::print("wrote {}\n", options.out.string());
    if (!options.json.empty()) fmt::print("wrote {}\n", options.json.string());
    return validationVerdict(*session->device);
}

}  // namespace

void addRebuild(CLI::App& app, int& exitCode) {
    auto o = std::make_shared<Options>();
    CLI::App* command =
        app.add_subcommand("rebuild", "render a captured frame at any size, given the same scene");
    command->add_option("STREAM", o->stream, "a .lvis file of `lodestar capture`")
        ->type_name("")
        ->required();
    addSceneArgument(*command, o->scene);
    command->add_option("--out", o->out, "the picture, a PNG")->type_name("FILE")->required();
    command
        ->add_option_function<std::string>(
            "--size",
            [o](const std::string& text) {
                const auto size = parseSize(text);
                if (!size) throw CLI::ValidationError("--size", size.error().message);
                o->size = *size;
            },
            "output size in pixels; without it that of the capture's samples")
        ->type_name("WxH");
    command->add_flag(
        "--antialias", o->antialias,
        "at the capture's base size, every triangle of a pixel weighed by its samples");
    command->add_option("--shading-rate", o->shadingRate, "r of the coarse terms; 1 = full quality")
        ->type_name("R")
        ->check(CLI::Range(1.0, 64.0))
        ->capture_default_str()
        ->group("Shading");
    command->add_flag("--reference", o->reference,
                      "also render the scene directly at this size and report PSNR, SSIM and FLIP");
    addPostRateOption(*command, o->levers);
    addFrameOptions(*command, o->settings);
    addJsonOption(*command, o->json);
    addDeviceOption(*command, o->device.device);
    command->add_flag("--validate", o->device.validation, "run under the Vulkan validation layers");
    command->callback([o, &exitCode] { exitCode = finish(run(*o)); });
}

}  // namespace lodestar::app

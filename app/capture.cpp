// SPDX-License-Identifier: Apache-2.0
#include "app/capture.hpp"
#include "app/judge.hpp"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <lodestar/gpu/readback.hpp>

#include "app/bench/bench.hpp"
#include "app/console.hpp"
#include "app/whole_file.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

struct Options {
    std::string scene;
    gpu::DeviceRequest device;
    ViewOptions view;
    frame::CaptureSettings settings;
    double seconds = 0;
    fs::path out, json;
};

template <typename T>
std::vector<T> recordsOf(const Session& session, const gpu::TexelBuffer& buffer) {
    return gpu::as<T>(gpu::readBuffer(*session.device, buffer.buffer(), buffer.buffer().bytes()));
}

Json settingsJson(const frame::CaptureFrame& capture, const Options& options) {
    return {{"width", options.settings.base.width},
            {"height", options.settings.base.height},
            {"capture_rate", options.settings.side * options.settings.side},
            {"capture", nameOf(capture.backend())},
            {"bands", capture.bands()},
            {"seconds", options.seconds}};
}

void printSummary(const visibility::Record& record, const frame::CaptureFrame& capture,
                  const visibility::RecordBytes& bytes, std::size_t streamBytes, double ms) {
    const double thesis = static_cast<double>(bytes.thesisTotal());
    const auto share = [&](std::uint64_t part) {
        return fmt::format("{:.1f} % of the thesis's layout",
                           100 * static_cast<double>(part) / thesis);
    };
    Table table({{""}, {"", Table::Align::right}, {""}});
    table.row({"captured", formatMs(ms),
               fmt::format(
                   "{}x{} samples by {} in {}", capture.gridC().width, capture.gridC().height,
                   nameOf(capture.backend()),
                   capture.bands() == 1 ? "one band" : fmt::format("{} bands", capture.bands()))});
    table.row({"mixed pixels", formatCount(bytes.mixedPixels),
               fmt::format("of {}", formatCount(record.heads.size()))});
    table.row({"list entries", formatCount(record.nodes.size()), ""});
    table.row({"in memory", formatBytes(bytes.total()), share(bytes.total())});
    table.row({"in the file", formatBytes(streamBytes), share(streamBytes)});
    table.row({"while capturing", formatBytes(capture.transientBytes()), "beside the record"});
    fmt::print("{}", table.text());
}

Result<void> run(Options options) {
    auto session = openSession(options.scene, options.device);
    if (!session) return tl::unexpected(session.error());
    const auto camera = resolveCamera(*session, options.view);
    if (!camera) return tl::unexpected(camera.error());
    const PictureSize size = options.view.size;
    options.settings.base = vk::Extent2D{static_cast<std::uint32_t>(size.width),
                                         static_cast<std::uint32_t>(size.height)};
    const std::uint32_t most = 16384 / options.settings.side;
    if (options.settings.base.width > most || options.settings.base.height > most)
        return fail(fmt::format(
            "--size: {}x{} at {} samples a pixel is beyond 16384 samples a "
            "side: at most {}x{}",
            size.width, size.height, options.settings.side * options.settings.side, most, most));
    const auto seconds = static_cast<float>(options.seconds);
    if (session->gpuScene->animated()) session->gpuScene->animate(seconds);

    fmt::print("{} at {}x{} on {}\n", printable(options.scene), size.width, size.height,
               session->device->description().name);
    if (options.settings.backend == frame::CaptureBackend::automatic)
        options.settings.backend =
            frame::chooseBackend(*session->device, *session->gpuScene, options.settings, *camera);
    frame::CaptureFrame capture(*session->device, *session->gpuScene, options.settings);
    const frame::CaptureFrame::Done done = capture.capture(*camera);
    if (done.recaptured > 0)
        fmt::print(
            "note: captured again: the first pool had room for {} words of lists, {} needed\n",
            formatCount(done.recaptured), formatCount(capture.compact().wordsNeeded()));
    visibility::Stream stream{
        .record = visibility::readRecord(*session->device, capture.compact()),
        .camera = *camera,
        .aspect = static_cast<float>(size.width) / static_cast<float>(size.height),
        .seconds = seconds,
        .scene = options.scene.substr(0, 1023),
        .sceneHash = visibility::hashOf(*session->scene),
        .clusterHash = clusterHashOf(*session)};
    const std::vector<std::byte> file = visibility::encodeStream(stream);
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (auto written = writeWholeFile(options.out, text); !written) return written;

    const visibility::RecordBytes bytes = visibility::bytesOf(stream.record);
    printSummary(stream.record, capture, bytes, file.size(), done.times.gpuMs);
    if (!options.json.empty()) {
        Report report;
        describeDevice(*session, report);
        report.settings = settingsJson(capture, options);
        report.passes = summarisePasses({costsOf(done.times)});
        report.frameMs = done.times.gpuMs;
        report.counts = {{"list_nodes", stream.record.nodes.size()},
                         {"mixed_pixels", bytes.mixedPixels},
                         {"triangles_total", session->gpuScene->triangleCount()}};
        report.more["stream"] = {{"file_bytes", file.size()},
                                 {"heads_bytes", bytes.heads},
                                 {"lists_bytes", bytes.lists},
                                 {"thesis_layout_bytes", bytes.thesisTotal()},
                                 {"transient_bytes", capture.transientBytes()}};
        if (auto written = writeJson(options.json, toJson(report)); !written) return written;
    }
    fmt::print("wrote {}\n", options.out.string());
    if (!options.json.empty()) fmt::print("wrote {}\n", options.json.string());
    return validationVerdict(*session->device);
}

}  // namespace

std::string nameOf(frame::CaptureBackend backend) {
    return std::string(frame::kCaptureBackendNames[static_cast<std::size_t>(backend)]);
}

std::uint64_t clusterHashOf(const Session& session) {
    const auto& scene = *session.gpuScene;
    std::uint64_t hash = 0;
    // Of the table, what no view changes.
    const std::pair<const gpu::TexelBuffer*, std::uint64_t> parts[]{
        {&scene.clusters, sizeof(shared::GpuCluster) * std::uint64_t{scene.clusterCapacity()}},
        {&scene.triangles, scene.triangles.buffer().bytes()}};
    for (const auto& [buffer, bytes] : parts)
        hash = visibility::hashOf(gpu::readBuffer(*session.device, buffer->buffer(), bytes), hash);
    return hash;
}

Result<void> checkIds(const Session& session, const visibility::Record& record) {
    const auto clusters = recordsOf<shared::GpuCluster>(session, session.gpuScene->clusters);
    const auto known = [&](std::uint32_t id) {
        const std::uint32_t cluster = id >> shared::LS_TRIANGLE_BITS;
        return id == 0 || (cluster > 0 && cluster < session.gpuScene->clusterCapacity() &&
                           (id & shared::LS_TRIANGLE_MASK) < clusters[cluster].triangleCount);
    };
    const bool good = std::all_of(record.heads.begin(), record.heads.end(),
                                  [&](const auto& head) { return known(head.id); }) &&
                      std::all_of(record.nodes.begin(), record.nodes.end(),
                                  [&](const auto& node) { return known(visibility::idOf(node)); });
    if (good) return {};
    return fail("it names triangles that the scene does not have; capture it again");
}

void addCaptureOptions(CLI::App& app, frame::CaptureSettings& settings) {
    addParsed(
        app, "--capture", settings.backend,
        [](const std::string& text) -> Result<frame::CaptureBackend> {
            const auto& names = frame::kCaptureBackendNames;
            const auto found = std::find(names.begin(), names.end(), text);
            if (found != names.end()) return frame::CaptureBackend(found - names.begin());
            return fail("'" + text + "' is no way to capture: auto, ss, ms or compute");
        },
        "how visibility is sampled: auto (default), ss (supersampling), ms (multisample passes) or "
        "compute")
        ->type_name("HOW")
        ->group("Visibility");
    addParsed(
        app, "--capture-rate", settings.side,
        [](const std::string& text) -> Result<std::uint32_t> {
            if (text == "1") return 1;
            if (text == "4") return 2;
            if (text == "16") return 4;
            if (text == "64") return 8;
            return fail("'" + text + "' is no capture rate: 1, 4, 16 or 64 samples a pixel");
        },
        "samples a pixel: 1, 4, 16 or 64")
        ->type_name("N")
        ->default_str(std::to_string(settings.side * settings.side))
        ->group("Visibility");
}

void addCapture(CLI::App& app, int& exitCode) {
    auto o = std::make_shared<Options>();
    o->settings.side = 4;
    CLI::App* command = app.add_subcommand(
        "capture",
        "write what a frame shows, to be rebuilt later at any size (`lodestar rebuild`)");
    addSceneArgument(*command, o->scene);
    command->add_option("--out", o->out, "the stream, a .lvis file")->type_name("FILE")->required();
    addViewOptions(*command, o->view);
    command->get_option("--size")->description(
        "base size in pixels; each holds --capture-rate samples");
    addCaptureOptions(*command, o->settings);
    command->add_option("--time", o->seconds, "when in the animation, in seconds")
        ->type_name("S")
        ->check(CLI::NonNegativeNumber)
        ->group("View");
    addJsonOption(*command, o->json);
    addDeviceOption(*command, o->device.device);
    command->add_flag("--validate", o->device.validation, "run under the Vulkan validation layers");
    command->callback([o, &exitCode] { exitCode = finish(run(*o)); });
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/flicker.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/filter_runs.hpp"
#include "app/camera_path.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;
using budget::median;
using scale::TemporalMode;

constexpr std::size_t kModes = scale::kTemporalNames.size();  // off: the scaling filter alone
constexpr std::size_t kJudged = 8;                            // last frames of a run
constexpr float kAnimatedFrom = 1;                            // seconds
constexpr std::uint32_t kFine = 4;  // samples a pixel of the truth, along each axis

constexpr std::size_t kEnoughUncovered = 20;              // pixels whose error says something
constexpr std::size_t kTimedRuns = 9, kTimedFrames = 20;  // of a course on which S changes
constexpr std::size_t kPanFrames = 80;  // of a course's path, however many are run

/// What the camera, the scene and S do over a run.
struct Course {
    const char* name;
    const char* path;  ///< "" = the camera stands still
    bool animates;
    std::vector<float> scales;  ///< in turn; the first names the run
};

const std::vector<Course>& courses() {
    static const std::vector<Course> all{
        {"still", "", false, {0.71f}},
        {"still", "", false, {0.5f}},
        {"pan", "orbit:6", false, {0.71f}},
        {"pan", "orbit:6", false, {0.5f}},
        {"moving", "", true, {0.71f}},
        {"S changing", "", false, {0.71f, 0.6f, 0.82f, 0.66f, 0.76f}}};
    return all;
}

quality::MotionField fieldOf(const std::vector<glm::vec4>& motion, vk::Extent2D size,
                             const std::vector<std::uint8_t>& uncovered) {
    quality::MotionField field{static_cast<int>(size.width), static_cast<int>(size.height), {}};
    for (std::size_t i = 0; i < motion.size(); ++i) {
        const bool lost = uncovered[i] != 0;
        field.offsets.push_back(lost ? NAN : motion[i].x * static_cast<float>(size.width));
        field.offsets.push_back(lost ? NAN : motion[i].y * static_cast<float>(size.height));
    }
    return field;
}

/// Pixels whose surface the frame before did not show: what was at their place then lay nearer.
std::vector<std::uint8_t> uncoveredMask(const std::vector<glm::vec4>& motion,
                                        const std::vector<float>& depthBefore, vk::Extent2D size) {
    std::vector<std::uint8_t> mask(motion.size());
    for (std::size_t i = 0; i < motion.size(); ++i) {
        const glm::vec4 m = motion[i];
        const float x = static_cast<float>(i % size.width) + m.x * static_cast<float>(size.width);
        const float y = static_cast<float>(i / size.width) + m.y * static_cast<float>(size.height);
        const auto column = std::lround(x), row = std::lround(y);
        if (column < 0 || row < 0 || column >= size.width || row >= size.height) continue;
        const float before =
            depthBefore[static_cast<std::size_t>(row) * size.width + std::size_t(column)];
        mask[i] = before > 0 && (m.w == 0 || before < 0.95f * m.z);
    }
    return mask;
}

double errorIn(const quality::RgbImage& reference, const quality::RgbImage& test,
               const std::vector<std::uint8_t>& mask) {
    double sum = 0;
    for (std::size_t i = 0; i < mask.size(); ++i)
        if (mask[i] != 0)
            for (std::size_t c = 0; c < 3; ++c)
                sum += std::abs(int{reference.rgb[3 * i + c]} - int{test.rgb[3 * i + c]});
    return sum;
}

/// One way of joining over a run.
struct Joined {
    std::vector<double> frameMs, passMs, psnr, supersampled, flicker;
    double uncoveredError = 0;  ///< of the judged frames
    quality::RgbImage picture, before;
};

double passMs(const gpu::FrameTimes& times) {
    double sum = 0;
    for (const gpu::PassTime& pass : times.passes)
        if (pass.name == "temporal" || pass.name == "sharpen" || pass.name == "scale" ||
            pass.name == "motion")
            sum += pass.ms;
    return sum;
}

struct Stage {
    Session* session;
    scene::Camera camera;
    std::size_t frames;
    std::array<std::optional<frame::Frame>, kModes> methods;
    std::optional<frame::Frame> full;    ///< S = 1, nothing joined
    std::optional<frame::Frame> native;  ///< S = 1, joined by our mode
    std::optional<frame::Frame> alone;   ///< our mode's frames without their history
    std::optional<frame::Frame> fine;    ///< kFine² samples a pixel
    std::optional<FilterRuns> filters;
};

/// A picture of kFine times the size, each pixel the mean of what it shows.
quality::RgbImage reduced(const quality::RgbImage& large) {
    quality::RgbImage small(large.width / int(kFine), large.height / int(kFine));
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x)
            for (int c = 0; c < 3; ++c) {
                unsigned sum = 0;
                for (int i = 0; i < int(kFine * kFine); ++i) {
                    const int u = x * int(kFine) + i % int(kFine);
                    const int v = y * int(kFine) + i / int(kFine);
                    sum += large.rgb[std::size_t(3 * (v * large.width + u) + c)];
                }
                constexpr unsigned kSamples = kFine * kFine;
                small.rgb[std::size_t(3 * (y * small.width + x) + c)] =
                    std::uint8_t((sum + kSamples / 2) / kSamples);
            }
    return small;
}

/// The longest frame of a run of our mode over the median one. Of each frame the median of many
/// runs: what it costs more than another, not what else the machine did. The first has no picture
/// before it to cull by, whatever its S, and does not count.
double longestFrame(Stage& stage, const Course& course) {
    frame::Frame& frame = *stage.methods[std::size_t(TemporalMode::lodestar)];
    std::vector<std::vector<double>> runs(kTimedFrames);
    for (std::size_t run = 0; run < kTimedRuns; ++run) {
        frame.reset();
        for (std::size_t i = 0; i < kTimedFrames; ++i) {
            const float s = course.scales[i % course.scales.size()];
            runs[i].push_back(frame.render(stage.camera, {.renderScale = s}).gpuMs);
        }
    }
    std::vector<double> medians;
    for (std::size_t i = 1; i < kTimedFrames; ++i) medians.push_back(median(runs[i]));
    return *std::max_element(medians.begin(), medians.end()) / median(medians);
}

struct CourseResult {
    std::array<Joined, kModes> methods;
    double bestSpatialDb = 0;      ///< of all filters without noise, on the last frame
    std::vector<double> nativeDb;  ///< of the native picture against the truth
    std::size_t uncovered = 0;
    double aloneError = 0;  ///< where uncovered, of our mode's frames without their history
    quality::RgbImage full;
    double longest = NAN;  ///< frame of our mode / its median, where S changes
};

CourseResult runCourse(Stage& stage, const Course& course) {
    const Session& session = *stage.session;
    const gpu::Device& device = *session.device;
    const auto path = course.path[0] != 0 ? parsePath(course.path) : CameraPath{};
    CourseResult result;
    quality::RgbImage fullBefore;
    std::vector<float> depthBefore;
    // The course before may have left the scene at another time.
    if (session.gpuScene->animated())
        session.gpuScene->animate(course.animates ? kAnimatedFrom : 0);
    // By the frame that has no history.
    warmUp([&] { return stage.full->render(stage.camera, {}); });
    for (auto& method : stage.methods) method->reset();
    stage.full->reset();
    stage.native->reset();
    stage.alone->reset();
    const std::size_t judgedFrom = stage.frames - kJudged;
    for (std::size_t i = 0; i < stage.frames; ++i) {
        const scene::Camera camera = path->at(stage.camera, i, kPanFrames);
        if (course.animates) session.gpuScene->animate(kAnimatedFrom + static_cast<float>(i) / 60);
        const bool judged = i >= judgedFrom, before = i + 1 >= judgedFrom;
        const float s = course.scales[i % course.scales.size()];
        std::vector<std::uint8_t> uncovered;
        quality::MotionField field;
        quality::RgbImage full, native, fine;
        stage.native->render(camera, {});
        stage.alone->render(camera, {.renderScale = s});
        if (before) {
            stage.full->render(camera, {});
            full = readDisplay(device, *stage.full);
            const vk::Extent2D size = full.width > 0 ? stage.full->grid() : vk::Extent2D{};
            if (judged) {
                const auto motion =
                    gpu::as<glm::vec4>(gpu::readImage(device, stage.full->motion()));
                uncovered = uncoveredMask(motion, depthBefore, size);
                field = fieldOf(motion, size, uncovered);
                result.uncovered += static_cast<std::size_t>(
                    std::count(uncovered.begin(), uncovered.end(), std::uint8_t{1}));
                native = readDisplay(device, *stage.native);
                stage.fine->render(camera, {});
                fine = reduced(readDisplay(device, *stage.fine));
                result.nativeDb.push_back(quality::psnr(fine, native));
                result.aloneError += errorIn(fine, readDisplay(device, *stage.alone), uncovered);
            }
            depthBefore = gpu::as<float>(gpu::readImage(device, stage.full->depth()));
        }
        for (std::size_t m = 0; m < kModes; ++m) {
            const auto times = stage.methods[m]->render(camera, {.renderScale = s});
            Joined& joined = result.methods[m];
            if (i > 1) joined.frameMs.push_back(times.gpuMs);
            if (i > 1) joined.passMs.push_back(passMs(times));
            if (!before) continue;
            joined.picture = readDisplay(device, *stage.methods[m]);
            if (judged) {
                joined.psnr.push_back(quality::psnr(native, joined.picture));
                joined.supersampled.push_back(quality::psnr(fine, joined.picture));
                joined.flicker.push_back(
                    quality::flicker(fullBefore, full, joined.before, joined.picture, &field));
                joined.uncoveredError += errorIn(fine, joined.picture, uncovered);
            }
            joined.before = joined.picture;
        }
        fullBefore = full;
        if (i + 1 < stage.frames) continue;
        result.full = full;
        for (const auto filter : {scale::Filter::point, scale::Filter::bilinear,
                                  scale::Filter::bicubic, scale::Filter::edgeAdaptive}) {
            stage.filters->run(*stage.methods[0], {.filter = filter});
            result.bestSpatialDb =
                std::max(result.bestSpatialDb, quality::psnr(fine, stage.filters->picture()));
        }
    }
    if (course.scales.size() > 1) result.longest = longestFrame(stage, course);
    return result;
}

double mean(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value / static_cast<double>(values.size());
    return sum;
}

void addRows(const CourseResult& run, const Course& course, const BenchCase& what,
             const BenchOptions& options, Json& rows) {
    for (std::size_t m = 0; m < kModes; ++m) {
        const Joined& joined = run.methods[m];
        const double ms = median(joined.frameMs);
        const auto over = [&](double error) {
            return finiteOrNull(error > 0 ? joined.uncoveredError / error : NAN);
        };
        rows.push_back({{"measures", "temporal"},
                        {"scene", fs::path(what.scene).filename().string()},
                        {"camera", what.camera},
                        {"width", options.view.size.width},
                        {"height", options.view.size.height},
                        {"path", course.name},
                        {"s", std::round(100.0 * double{course.scales.front()}) / 100},
                        {"method", m == 0 ? "none" : std::string(scale::kTemporalNames[m])},
                        {"frames", joined.frameMs.size() + 2},
                        {"frame_ms", ms},
                        {"longest_frame_ratio", finiteOrNull(m + 1 == kModes ? run.longest : NAN)},
                        {"joining_ms", median(joined.passMs)},
                        {"psnr_db", finiteOrNull(mean(joined.psnr))},
                        {"supersampled_psnr_db", finiteOrNull(mean(joined.supersampled))},
                        {"native_supersampled_psnr_db", finiteOrNull(mean(run.nativeDb))},
                        {"best_spatial_psnr_db", finiteOrNull(run.bestSpatialDb)},
                        {"flicker", finiteOrNull(mean(joined.flicker))},
                        {"uncovered_pixels", run.uncovered},
                        {"uncovered_error_ratio", over(run.aloneError)},
                        {"uncovered_over_none", over(run.methods[0].uncoveredError)}});
    }
}

Result<void> measureScene(const BenchCase& what, const BenchOptions& options, BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    auto& [session, camera] = *opened;
    const gpu::Device& device = *session.device;
    frame::FrameSettings settings = options.settings;
    settings.maxScale = 1;
    settings.temporal.mode = TemporalMode::off;
    Stage stage{.session = &session, .camera = camera, .frames = options.frames};
    const vk::Extent2D size = settings.size;
    settings.size = vk::Extent2D{size.width * kFine, size.height * kFine};
    stage.fine.emplace(device, *session.gpuScene, settings);
    stage.fine->render(camera, {});
    settings.exposure = stage.fine->settings().exposure;
    settings.size = size;
    for (std::size_t m = 0; m < kModes; ++m) {
        settings.temporal.mode = TemporalMode(m);
        stage.methods[m].emplace(device, *session.gpuScene, settings);
    }
    settings.temporal.mode = TemporalMode::lodestar;
    stage.native.emplace(device, *session.gpuScene, settings);
    settings.temporal.memory = 0;
    stage.alone.emplace(device, *session.gpuScene, settings);
    settings.temporal.memory = options.settings.temporal.memory;
    settings.temporal.mode = TemporalMode::off;
    settings.motion = true;
    stage.full.emplace(device, *session.gpuScene, settings);
    stage.filters.emplace(device, settings.size);

    if (!result.report.device) {
        describeDevice(session, result.report);
        result.report.counts = countsOf(session, *stage.fine);
    }

    Progress bar("measuring", courses().size());
    std::size_t done = 0;
    for (const Course& course : courses()) {
        bar.update(done++);
        if (course.animates && !session.gpuScene->animated()) continue;
        const CourseResult run = runCourse(stage, course);
        addRows(run, course, what, options, result.rows);
        if (auto done = options.rowsCame(result); !done) return done;
        if (course.scales.front() != 0.5f && std::string_view(course.name) != "pan") continue;
        std::string name = course.name;
        std::replace(name.begin(), name.end(), ' ', '-');
        for (std::size_t m = 0; m <= kModes; ++m) {
            const std::string method = m == kModes ? "full"
                                       : m == 0    ? "none"
                                                   : std::string(scale::kTemporalNames[m]);
            result.files.push_back(options.out / fmt::format("temporal.{}.{}-{:.2f}.{}.png",
                                                             sceneSlug(what.scene), name,
                                                             course.scales.front(), method));
            const auto& picture = m == kModes ? run.full : run.methods[m].picture;
            if (auto written = writePng(result.files.back(), picture); !written) return written;
        }
    }
    bar.erase();
    return validationVerdict(device);
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = benchCases(options, {{"sponza.glb", "nave", ""},
                                            {"city_kaykit.glb", "street", ""},
                                            {"chess_abeautifulgame.glb", "pieces", ""},
                                            {"littlest_tokyo.glb", "street", ""},
                                            {"tests/CesiumMan.glb", "", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    for (const BenchCase& one : *cases)
        if (auto done = measureScene(one, options, result); !done)
            return tl::unexpected(done.error());
    return result;
}

const Json* rowOf(const Json& rows, const Json& like, const char* path, double s,
                  const char* method) {
    for (const Json& row : rows)
        if (row.at("scene") == like.at("scene") && row.at("path") == path && row.at("s") == s &&
            row.at("method") == method)
            return &row;
    return nullptr;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        if (row.at("method") != "lodestar") continue;
        const std::string path = row.at("path");
        const double s = row.at("s");
        const std::string place =
            fmt::format(": {}, S = {}", row.at("scene").get<std::string>(), s);
        const auto number = [&](const char* key) { return numberOrInfinity(row, key); };
        const double db = number("psnr_db");
        const auto bar = [&](const char* what, double goal) {
            bars.push_back({what + (", against native" + place), db, "dB",
                            fmt::format(">= {}", goal), db >= goal});
        };
        if (path == "still" && s > 0.5) bar("still view", 38);
        if (path == "pan" && s > 0.5) bar("panning", 34);
        if (path == "still" && s == 0.5) {
            const double gain = number("supersampled_psnr_db") - number("best_spatial_psnr_db");
            bars.push_back({"over the best spatial filter" + place, gain, "dB", ">= 3", gain >= 3});
        }
        // Of a pixel or two nothing follows.
        if (row.at("uncovered_pixels") >= kEnoughUncovered &&
            !row.at("uncovered_error_ratio").is_null()) {
            const double ratio = number("uncovered_error_ratio");
            bars.push_back({"error where uncovered / without history, " + path + place, ratio, "x",
                            "<= 1.05", ratio <= 1.05});
        }
        if (path == "S changing") {
            const Json* still = rowOf(rows, row, "still", s, "lodestar");
            const double loss =
                numberOrInfinity(*still, "supersampled_psnr_db") - number("supersampled_psnr_db");
            const double hitch = number("longest_frame_ratio");
            bars.push_back(
                {"loss when S changes every frame" + place, loss, "dB", "<= 0.5", loss <= 0.5});
            bars.push_back({"longest frame / median" + place, hitch, "x", "<= 1.5", hitch <= 1.5});
        }
    }
    return bars;
}

}  // namespace

Bench temporalBench() {
    return {.name = "temporal",
            .what = "quality over time of joined pictures: still, panning, moving, S changing",
            .run = run,
            .bars = barsOf,
            .tables = {{"temporal",
                        {"scene", "path", "s", "method", "frame_ms", "joining_ms", "psnr_db",
                         "supersampled_psnr_db", "native_supersampled_psnr_db",
                         "best_spatial_psnr_db", "flicker", "uncovered_pixels",
                         "uncovered_error_ratio", "uncovered_over_none"}}},
            .onCpu = Scope{{384, 216}, 1, 64},
            .onGpu = Scope{{1280, 720}, 1, 64}};
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <lodestar/budget/trace.hpp>

#include "app/bench/benches.hpp"
#include "app/bench/osg_view.hpp"
#include "app/console.hpp"
#include "app/frame_options.hpp"
#include "app/geometry_options.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"

namespace lodestar::app {
namespace {

namespace fs = std::filesystem;

/// Both draw the same instances at the same levels of detail with one sun and no shadows; frame by
/// frame in turns, by the CPU's clock.
Result<void> compare(const BenchCase& what, float errorPx, const BenchOptions& options,
                     BenchResult& result) {
    auto opened = openCase(what, options);
    if (!opened) return tl::unexpected(opened.error());
    const auto& [session, camera] = *opened;
    frame::FrameSettings settings = options.settings;
    settings.skyViews = settings.shadowTaps = 0;
    settings.wavePx = 0;  // relief, which OpenSceneGraph is not given
    if (settings.exposure == 0) settings.exposure = 1;
    settings.lod = {};
    if (errorPx > 0) settings.lod = {.mode = geometry::LodChoice::Mode::error, .errorPx = errorPx};
    frame::Frame frame(*session.device, *session.gpuScene, settings);

    const int width = options.view.size.width, height = options.view.size.height;
    const auto chains = scene::buildSceneLods(*session.scene, {.cache = scene::userCacheFolder()});
    auto view = OsgView::open(*session.scene, chains, camera,
                              {.width = width, .height = height, .errorPx = errorPx});
    if (!view) return tl::unexpected(view.error());

    for (int i = 0; i < 3; ++i) {  // uploads, and the picture before that hides
        view->frame();
        frame.render(camera, {});
    }
    std::vector<double> ours, theirs;
    std::vector<budget::FrameCosts> costs;
    for (int i = 0; i < options.rounds; ++i) {
        theirs.push_back(view->frame());
        const gpu::FrameTimes times = frame.render(camera, {});
        ours.push_back(times.wallMs);
        costs.push_back(costsOf(times));
    }
    const Json counts = countsOf(session, frame);
    const double osgMs = budget::median(theirs), lodestarMs = budget::median(ours);
    result.rows.push_back({{"measures", "frames"},
                           {"scene", fs::path(what.scene).filename().string()},
                           {"camera", what.camera},
                           {"width", width},
                           {"height", height},
                           {"lod", nameOf(settings.lod)},
                           {"rounds", ours.size()},
                           {"instances", counts.at("instances_total")},
                           {"osg_ms", osgMs},
                           {"lodestar_ms", lodestarMs},
                           {"ratio", osgMs / std::max(lodestarMs, 1e-9)},
                           {"osg_triangles", view->triangles()},
                           {"lodestar_triangles", counts.at("triangles_visible")},
                           {"osg_renderer", view->renderer()}});
    if (result.report.passes.empty()) {
        describeDevice(session, result.report);
        result.report.passes = summarisePasses(costs);
        result.report.frameMs = lodestarMs;
        result.report.counts = counts;
    }
    const std::string stem =
        fmt::format("scene-graph.{}.{}", sceneSlug(what.scene), errorPx > 0 ? "lod" : "off");
    for (const auto& [name, picture] :
         {std::pair{"osg", view->picture()},
          std::pair{"lodestar", readDisplay(*session.device, frame)}}) {
        const fs::path file = options.out / fmt::format("{}.{}.png", stem, name);
        result.files.push_back(file);
        if (auto written = writePng(file, picture); !written) return written;
    }
    return validationVerdict(*session.device);
}

Result<BenchResult> run(const BenchOptions& options) {
    const auto cases = benchCases(options, {{"builtin:mountains:14500", "valley", ""}});
    if (!cases) return tl::unexpected(cases.error());
    BenchResult result;
    result.report.settings = settingsJson(options.settings);
    for (const BenchCase& one : *cases)
        for (const float errorPx : {0.0f, options.settings.lod.errorPx})
            if (auto done = compare(one, errorPx, options, result); !done)
                return tl::unexpected(done.error());
    return result;
}

std::vector<Bar> barsOf(const Json& rows) {
    std::vector<Bar> bars;
    for (const Json& row : rows) {
        const double ratio = row.at("ratio");
        bars.push_back(
            {fmt::format("frames of OpenSceneGraph's, LOD {}: {}", row.at("lod").get<std::string>(),
                         row.at("scene").get<std::string>()),
             ratio, "x", ">= 5", ratio >= 5});
    }
    return bars;
}

}  // namespace

Bench sceneGraphBench() {
    return {.name = "scene-graph",
            .what = "the same instances and levels of detail drawn by OpenSceneGraph",
            .run = run,
            .bars = barsOf,
            .tables = {{"frames",
                        {"scene", "lod", "osg_ms", "lodestar_ms", "ratio", "osg_triangles",
                         "lodestar_triangles"}}}};
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#include "app/budget_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <lodestar/budget/controllers.hpp>

#include "app/console.hpp"

namespace lodestar::app {

Calibration calibrate(frame::Frame& frame, const scene::Camera& camera,
                      const budget::Levers& levers, int rounds) {
    constexpr std::array kRates{1.0f, 2.0f, 4.0f};
    const auto at = [&](float rate) {
        budget::Levers changed = levers;
        changed.shadingRate = rate;
        return changed;
    };
    std::array<std::vector<double>, kRates.size()> times;
    Progress bar("calibrating", kRates.size() * static_cast<std::size_t>(rounds + 1));
    std::size_t done = 0;
    for (int round = -1; round < rounds; ++round)  // the first is the warm-up
        for (std::size_t i = 0; i < kRates.size(); ++i) {
            const double ms = frame.render(camera, at(kRates[i])).gpuMs;
            if (round >= 0) times[i].push_back(ms);
            bar.update(++done);
        }
    return {budget::median(times[0]),
            budget::fitCostModel(2, budget::median(times[1]), 4, budget::median(times[2]))};
}

Json traceRows(const Run& run) {
    Json rows = Json::array();
    for (const budget::TraceFrame& f : run.trace.frames()) {
        const std::size_t i = rows.size();
        const budget::Levers& levers = run.levers[i];
        Json row = {{"frame", i},
                    {"r", levers.shadingRate},
                    {"frame_ms", f.ms},
                    {"target_ms", f.targetMs},
                    {"s", levers.renderScale.mean()},
                    {"s_x", levers.renderScale.x},
                    {"s_y", levers.renderScale.y},
                    {"layer_scale", levers.layerScale},
                    {"shadow_scale", levers.shadowScale}};
        for (const budget::PassCost& pass : run.costs[i].passes)
            row[pass.name + "_ms"] = row.value(pass.name + "_ms", 0.0) + pass.ms;
        rows.push_back(row);
    }
    return rows;
}

std::string mediansOf(const Run& run, const budget::ScaleControls& controls, std::size_t settling) {
    const auto median = [&](const auto& of) {
        std::vector<double> values;
        for (std::size_t i = settling; i < run.levers.size(); ++i)
            values.push_back(of(run.levers[i]));
        return budget::median(values);
    };
    using L = const budget::Levers&;
    std::string text;
    const auto add = [&](bool controlled, const char* name, double value) {
        if (controlled) text += fmt::format("{}{} = {:.2f}", text.empty() ? "" : ", ", name, value);
    };
    add(controls.render, "S", median([](L l) { return l.renderScale.mean(); }));
    add(controls.layer, "layer", median([](L l) { return l.layerScale; }));
    add(controls.shadow, "shadow", median([](L l) { return l.shadowScale; }));
    return text;
}

Run renderRun(const Session& session, frame::Frame& frame, const scene::Camera& start,
              const RunOptions& options, const std::function<Result<void>(std::size_t)>& afterFrame,
              Result<void>& outcome) {
    Run run;
    budget::Levers levers = options.levers;
    std::optional<budget::YangController> controller;
    std::optional<budget::ProportionalController> scaling;
    if (options.targetMs && options.proportional) {
        budget::ProportionalSettings settings = *options.proportional;
        settings.targetMs = *options.targetMs;
        scaling.emplace(settings, std::clamp(1.0, settings.least, settings.most));
        levers = scaling->drive(options.levers);
    } else if (options.targetMs) {
        budget::YangSettings settings{.targetMs = *options.targetMs,
                                      .k = options.calibration.model.k};
        const double rate = options.calibration.model.rateFor(*options.targetMs);
        const double startRate =
            *options.targetMs >= options.calibration.fullMs ? 1 : std::clamp(rate, 1.0, 8.0);
        controller.emplace(settings, startRate);
        levers.shadingRate = static_cast<float>(startRate);
    }
    Progress bar("rendering", options.frames);
    std::size_t nextSample = 0;
    for (std::size_t i = 0; i < options.frames; ++i) {
        gpu::FrameTimes deforming;
        if (session.gpuScene->animated())
            deforming = session.gpuScene->animate(options.secondsAt(i));
        const scene::Camera camera = options.path.at(start, i, options.frames);
        gpu::FrameTimes times = frame.render(camera, levers);
        times.precede(deforming);
        const budget::FrameCosts costs = costsOf(times);
        run.costs.push_back(costs);
        run.lastRate = levers.shadingRate;
        run.lastCamera = camera;
        run.levers.push_back(levers);
        if (controller) {
            run.trace.add({levers.shadingRate, costs.gpuMs, *options.targetMs});
            levers.shadingRate = controller->next(costs).shadingRate;
            run.saturated = controller->saturated();
        }
        if (scaling) {
            run.trace.add({std::max(1.0, 1 / scaling->scale()), costs.gpuMs, *options.targetMs});
            scaling->update(costs);
            levers = scaling->drive(options.levers);
            run.saturated = scaling->saturated();
        }
        // Samples: the last frame of each of `samples` equal parts of the run.
        if (nextSample < options.samples &&
            i + 1 == (nextSample + 1) * options.frames / options.samples) {
            run.samples.push_back(
                {i, options.secondsAt(i), camera, readDisplay(*session.device, frame)});
            ++nextSample;
        }
        outcome = afterFrame(i);
        if (!outcome) break;
        bar.update(i + 1);
    }
    return run;
}

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <lodestar/frame/frame.hpp>

#include "app/report_json.hpp"

namespace lodestar::app {

/// Adds the options that say how frames are rendered (terms, reconstruction, light), for render and
/// bench. `settings` must outlive the parsing; its size is set by the view options.
void addFrameOptions(CLI::App&, frame::FrameSettings& settings);

/// Share of the pixels that is repaired at most, where nothing else is asked for.
inline constexpr float kRepair = 0.02f;

/// Spread of a local rate that is asked for without one.
inline constexpr float kLocalRate = 0.03f;

/// Adds --repair; sets `share` to what it is without it.
void addRepairOption(CLI::App&, float& share);
/// Adds --local-rate.
void addLocalRateOption(CLI::App&, float& spread);
/// Adds --shading-rate, --repair, --local-rate, --full-resize, the scales and --post-rate. `levers`
/// must outlive the parsing.
void addLeverOptions(CLI::App&, budget::Levers& levers);
Json leversJson(const budget::Levers&);

/// The settings as used, for --json.
Json settingsJson(const frame::FrameSettings&);

std::string nameOf(upsample::Reconstruct);

}  // namespace lodestar::app

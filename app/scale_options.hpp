// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <lodestar/budget/levers.hpp>

#include "app/console.hpp"
#include "app/report_json.hpp"

namespace lodestar::app {

/// Reads "0.5", or "0.5x1" for x and y: each 0.5 … 2.
Result<budget::AxisScale> parseAxisScale(const std::string& text);
/// "0.5" or "0.5x1".
std::string nameOf(budget::AxisScale);

/// Adds --scale, --layer-scale and --shadow-scale. `levers` must outlive the parsing.
void addScaleOptions(CLI::App&, budget::Levers& levers);
/// What they are, for --json.
Json scalesJson(const budget::Levers&);

}  // namespace lodestar::app

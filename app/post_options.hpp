// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <lodestar/budget/levers.hpp>
#include <lodestar/frame/post_settings.hpp>

#include "app/report_json.hpp"

namespace lodestar::app {

/// Adds the options of the effects, under the heading "Effects". `settings` must outlive the
/// parsing.
void addPostOptions(CLI::App&, frame::PostSettings& settings);

/// Adds --post-rate; sets the rates to what they are without it.
void addPostRateOption(CLI::App&, budget::Levers& levers);

Json postJson(const frame::PostSettings&);
Json postRatesJson(const budget::Levers&);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include <lodestar/budget/proportional_controller.hpp>
#include <lodestar/frame/frame.hpp>

#include "app/session.hpp"

namespace lodestar::app {

/// Who holds a budget, and by what.
struct ControllerOptions {
    std::string kind = "yang";
    double hysteresis = 0.05;
    int bands = 0;
    std::optional<budget::ScaleControls> controls;  ///< none: S alone
    std::filesystem::path trace;                    ///< CSV of the run; empty = none

    bool scales() const { return kind == "proportional"; }
};

/// Adds --controller, --controls, --hysteresis, --bands and --trace under "Run". `options` must
/// outlive the parsing.
void addControllerOptions(CLI::App&, ControllerOptions& options);

/// Refuses what says how a budget is held where there is none, or another controller.
Result<void> checkController(const ControllerOptions&, bool budget);

/// Reads "scale,layer,shadow" or a part of it.
Result<budget::ScaleControls> parseControls(const std::string& text);
/// The names of what is controlled, for --json.
Json controlsJson(const budget::ScaleControls&);

/// What the controller is told but for its target. What the scene has none of, or what would only
/// cost, is left out with a note on standard output; it fails where that leaves nothing.
Result<budget::ProportionalSettings> proportionalSettings(const ControllerOptions&, const Session&,
                                                          const frame::FrameSettings&);

}  // namespace lodestar::app

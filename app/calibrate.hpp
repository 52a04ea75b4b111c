// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace lodestar::app {

/// Adds `lodestar calibrate SCENE --out SETTINGS.json`.
void addCalibrate(CLI::App&, int& exitCode);

}  // namespace lodestar::app

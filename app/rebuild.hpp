// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// `lodestar rebuild`: a picture of any size from a .lvis file and its scene.
namespace lodestar::app {

void addRebuild(CLI::App&, int& exitCode);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace lodestar::app {

/// Adds `lodestar render`.
void addRender(CLI::App&, int& exitCode);

}  // namespace lodestar::app

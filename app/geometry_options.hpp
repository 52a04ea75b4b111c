// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <lodestar/frame/frame.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// Reads "off", "error:1" (pixels) or "distance:10,40" (scene units, growing).
Result<geometry::LodChoice> parseLod(const std::string& text);
Result<geometry::CullMode> parseCull(const std::string& text);
std::string nameOf(geometry::CullMode);
/// As parseLod reads it.
std::string nameOf(const geometry::LodChoice&);

/// Adds --cull, --lod, --relief and --show-lods under the heading "Geometry". Sets their
/// defaults.
void addGeometryOptions(CLI::App&, frame::FrameSettings&);

}  // namespace lodestar::app

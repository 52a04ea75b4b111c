// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/visibility/stream.hpp>

#include "app/session.hpp"

/// `lodestar capture`: a frame's visibility as a .lvis file.
namespace lodestar::app {

void addCapture(CLI::App&, int& exitCode);

/// Adds --capture and --capture-rate. `settings` must outlive the parsing.
void addCaptureOptions(CLI::App&, frame::CaptureSettings& settings);
std::string nameOf(frame::CaptureBackend);

/// Of the clusters and triangles that ids count: builds that cut meshes differently differ in it.
std::uint64_t clusterHashOf(const Session&);
/// A record read from a stream, checked against the scene it claims to be of.
Result<void> checkIds(const Session&, const visibility::Record&);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <lodestar/frame/frame.hpp>
#include <lodestar/quality/image.hpp>

#include "app/cli.hpp"
#include "app/report_json.hpp"

namespace lodestar::app {

/// A scene on a device, ready for frames: what render, bench and view start from.
struct Session {
    std::string sceneName;
    std::unique_ptr<const scene::Scene> scene;  ///< gpuScene refers to it, so it must not move
    std::unique_ptr<gpu::Device> device;
    std::unique_ptr<scene::GpuScene> gpuScene;
};

/// Loads `sceneName`, opens the device and uploads. What is missing in the picture is said on
/// standard output, one line a note. `opaque`: what is seen through is drawn opaque.
Result<Session> openSession(const std::string& sceneName, const gpu::DeviceRequest&,
                            bool opaque = false);

/// The camera `options` names: an explicit one, one of the scene, one of the `views.json` beside
/// the scene file, or the one that frames the scene.
Result<scene::Camera> resolveCamera(const Session&, const ViewOptions& options);

/// The last picture of `frame`.
quality::RgbImage readDisplay(const gpu::Device&, const frame::Frame& frame);

/// Device, driver and memory of the session, for --json.
void describeDevice(const Session&, Report&);

/// Frame costs as the governor and the reports take them.
budget::FrameCosts costsOf(const gpu::FrameTimes&);

}  // namespace lodestar::app

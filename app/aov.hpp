// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <lodestar/frame/frame.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// Reads "depth,normal" into names, each one of: depth [scene units], normal (view space), albedo,
/// roughness, metallic, occlusion, id, shadow (share of the sun seen), ao (share of the sky seen),
/// motion (from here to where the surface was a frame ago [pixels], y down).
Result<std::vector<std::string>> parseAovs(const std::string& text);

/// What a frame has to make so that `names` can be written of its pictures.
void keepForAovs(const std::vector<std::string>& names, frame::FrameSettings&);

/// Writes each of `names` of the last picture as `STEM.NAME.exr` beside `out`. Returns the files.
Result<std::vector<std::filesystem::path>> writeAovs(const gpu::Device&, const frame::Frame&,
                                                     const std::vector<std::string>& names,
                                                     const std::filesystem::path& out);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <lodestar/quality/image.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// Reads a PNG (8 or 16 bit; alpha dropped) or an EXR (R, G, B or Y, linear, clamped to 0 … 1 and
/// sRGB-encoded), by content rather than by name. Pictures over 16384 pixels a side are refused
/// before their pixels are allocated.
Result<quality::RgbImage> readImage(const std::filesystem::path&);

/// Writes a PNG. The file appears whole or not at all.
Result<void> writePng(const std::filesystem::path&, const quality::RgbImage&);

/// One named float channel of an EXR file, width × height, rows from the top.
struct ExrChannel {
    std::string name;
    std::vector<float> values;
};
Result<void> writeExr(const std::filesystem::path&, int width, int height,
                      const std::vector<ExrChannel>& channels);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <lodestar/quality/image.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// Reads a PNG (8 or 16 bit; alpha dropped) or an EXR (R, G, B or Y, linear, clamped to 0 … 1 and
/// sRGB-encoded), by content rather than by name. Pictures over 16384 pixels a side and files over
/// 2 GiB are refused before their pixels are allocated. Embedded gamma and colour profiles are
/// ignored: lodestar's own pictures are sRGB. EXR: data window of the first part; no DWA
/// compression.
Result<quality::RgbImage> readImage(const std::filesystem::path&);

/// The same from memory. `name` stands for the file in messages.
Result<quality::RgbImage> decodeImage(std::string_view bytes, const std::string& name);

/// Writes a PNG. The file appears whole or not at all.
Result<void> writePng(const std::filesystem::path&, const quality::RgbImage&);

/// One named float channel of an EXR file, width × height, rows from the top.
struct ExrChannel {
    std::string name;
    std::vector<float> values;
};
/// Writes 32-bit floats, ZIP-compressed. The file appears whole or not at all. Throws
/// std::invalid_argument when a channel is not width × height, has no name or one taken before.
Result<void> writeExr(const std::filesystem::path&, int width, int height,
                      const std::vector<ExrChannel>& channels);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include <lodestar/scene/scene.hpp>
#include <lodestar/shared/result.hpp>

/// Pictures that scenes bring along, as bytes nobody has vouched for. Messages go on from the
/// picture's name: "is too large: …".
namespace lodestar::scene {

struct ImageSize {
    int width = 0, height = 0;
};

/// An error for a picture of over 16384 texels a side or 64 Mi in all.
Result<void> checkImageSize(std::int64_t width, std::int64_t height);

/// Size of a PNG, JPEG, TGA, BMP, … by its header, if checkImageSize() allows it.
Result<ImageSize> readImageSize(std::span<const std::uint8_t> bytes);

/// Decodes it to RGBA. Takes no more memory than its size needs, nor longer, whatever its data say.
Result<Image> decodeImage(std::string name, std::span<const std::uint8_t> bytes);

bool isPng(std::span<const std::uint8_t> bytes);
bool isJpeg(std::span<const std::uint8_t> bytes);

}  // namespace lodestar::scene

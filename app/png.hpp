// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <lodestar/quality/image.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// The largest side of a picture that is read, in pixels.
inline constexpr int kMaxImageSide = 16384;

bool looksLikePng(std::string_view bytes);
Result<quality::RgbImage> decodePng(std::string_view bytes, const std::string& name);

}  // namespace lodestar::app

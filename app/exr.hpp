// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include <lodestar/quality/image.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

bool looksLikeExr(std::string_view bytes);
Result<quality::RgbImage> decodeExr(std::string_view bytes, const std::string& name);

}  // namespace lodestar::app

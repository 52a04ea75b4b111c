// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// Writes a file that appears whole or not at all: readers never see a half-written one, and a
/// failure leaves what was there before.
Result<void> writeWholeFile(const std::filesystem::path&, std::string_view bytes);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lodestar::scene {

/// Why a PLY or OFF file (`extension` in lower case, with its dot) cannot hold what it says it
/// holds, if so (an OFF file's indices included). assimp allocates what these formats' counts ask
/// for before it reads on, so that a file of a hundred bytes would take all memory of the machine.
std::optional<std::string> implausibleCounts(std::string_view bytes, std::string_view extension);

}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <lodestar/scene/scene.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::scene {

struct Builtin {
    std::string usage;        ///< as typed after `builtin:`, e.g. "grid:N"
    std::string description;  ///< one line
};

/// The procedural scenes there are, for `lodestar inspect builtin:`.
const std::vector<Builtin>& builtins();

/// Builds the scene `spec` names ("columns", "spheres", "grid:100000"). An unknown name or a bad N
/// is an error that lists what there is.
Result<Scene> buildBuiltin(const std::string& spec);

}  // namespace lodestar::scene

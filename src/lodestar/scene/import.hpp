// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <lodestar/scene/scene.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::scene {

/// Reads `source`: `builtin:NAME[:N]`, a glTF 2.0 file (.gltf, .glb), or any format assimp knows.
/// Every byte of a file is treated as hostile: an index, size, offset or hierarchy that is not true
/// is refused with one line naming the file and the place, and nothing is allocated that the file's
/// own size does not justify.
Result<Scene> load(const std::string& source);

Result<Scene> importGltf(const std::filesystem::path&);
Result<Scene> importAssimp(const std::filesystem::path&);

}  // namespace lodestar::scene

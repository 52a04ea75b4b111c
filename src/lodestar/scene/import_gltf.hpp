// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include <lodestar/scene/scene.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::scene {

/// importGltf() for a file that is already in memory, glb or JSON. `name` is what errors call it.
/// Files it refers to are read from under `folder`; with an empty `folder` such a scene is refused.
/// `bytes` are only read during the call.
Result<Scene> importGltfFromMemory(std::span<const std::uint8_t> bytes, const std::string& name,
                                   const std::filesystem::path& folder = {});

}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <lodestar/scene/scene.hpp>

struct aiScene;

namespace lodestar::scene {

/// Adds the hierarchy of `from` to `scene` (which has its meshes already): nodes, instances,
/// cameras and lights. `meshOf` maps assimp's meshes to the scene's (kNone: left out); a root node
/// scales file units to metres where `metresPerUnit` is not 1. Throws std::runtime_error on untrue
/// data.
void convertNodes(const aiScene& from, const std::vector<std::uint32_t>& meshOf,
                  float metresPerUnit, Scene& scene);

}  // namespace lodestar::scene

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <lodestar/scene/gpu_types.h>
#include <lodestar/scene/gpu_scene.hpp>
#include <lodestar/scene/texture_arrays.hpp>

/// Inside of GpuScene: the materials' records.
namespace lodestar::scene {

std::vector<shared::GpuMaterialRecord> packMaterials(const Scene&, const TextureArrays&);
/// What the records make of each feature; punctual lights are not theirs.
SceneFeatures featuresOf(const std::vector<shared::GpuMaterialRecord>&);

}  // namespace lodestar::scene

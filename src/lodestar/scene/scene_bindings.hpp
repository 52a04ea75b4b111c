// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/kernel.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::scene {

/// Slots 0 … 5 of every shader that includes scene.glsl, followed by its own.
inline std::vector<gpu::SlotArray> withSceneSlots(std::vector<gpu::SlotArray> own) {
    std::vector<gpu::SlotArray> slots(6, gpu::Slot::texelBuffer);
    slots.insert(slots.end(), own.begin(), own.end());
    return slots;
}

/// The scene's buffers for those slots, followed by the pass's own bindings.
inline std::vector<gpu::Binding> withScene(const GpuScene& scene, std::vector<gpu::Binding> own) {
    std::vector<gpu::Binding> bindings{scene.vertices, scene.attributes, scene.triangles,
                                       scene.meshlets, scene.instances,  scene.clusters};
    bindings.insert(bindings.end(), own.begin(), own.end());
    return bindings;
}

}  // namespace lodestar::scene

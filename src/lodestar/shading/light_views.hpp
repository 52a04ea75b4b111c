// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <lodestar/shading/light_params.h>
#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/scene.hpp>
#include <lodestar/shading/sky.hpp>

namespace lodestar::shading {

/// An orthographic depth map of a parallel light.
struct LightView {
    glm::mat4 clipFromWorld{1};  ///< reversed depth: nearest to the light = 1
    glm::mat4 mapFromWorld{1};   ///< world → (texel u, texel v, depth, 1)
    glm::vec3 toLight{0, 0, 1};
    float texel = 1;         ///< [scene units]
    std::uint32_t size = 1;  ///< texels a side
    float depthScale = 1;    ///< depth units per scene unit
    float weight = 1;        ///< of a view of the sky: luminance from there

    bool operator==(const LightView&) const = default;

    shared::GpuLightView params() const;
};

/// The sun's view of what the camera sees of `bounds`: the sphere about the scene, or, where that
/// is smaller, the sphere about the camera's view up to `distance` [scene units]. It moves in
/// steps, so that small camera moves leave it (and a map drawn with it) unchanged.
LightView fitSun(glm::vec3 toSun, const scene::Bounds& bounds, const scene::Camera& camera,
                 float aspect, float distance, std::uint32_t mapSize);

/// `count` views of the whole scene from evenly spread directions of the sky above the horizon
/// (a Fibonacci lattice), each with the luminance of the sky there.
std::vector<LightView> fitSky(const Sky&, const scene::Bounds& bounds, std::uint32_t count,
                              std::uint32_t mapSize);

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <glm/glm.hpp>

#include <lodestar/shading/light_params.h>

namespace lodestar::shading {

/// A shadow map in main memory: rows from the top, reversed depth (nearest to the sun = 1).
struct ShadowTexels {
    std::span<const float> depth;
    int width = 0, height = 0;
};

/// sunVisibility() of shadow.glsl in double precision, for tests: the share of the N×N-texel window
/// about `position` in which the receiver's plane, lifted by one texel, is not behind the map.
/// Empty texels (0) hide nothing, and windows that reach over the map's edge are lit. `faceNormal`:
/// world, unit length.
double sunVisibilityReference(const shared::LightParams&, const ShadowTexels&, glm::dvec3 position,
                              glm::dvec3 faceNormal);

}  // namespace lodestar::shading

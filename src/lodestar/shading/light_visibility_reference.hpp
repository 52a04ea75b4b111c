// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <glm/glm.hpp>

#include <lodestar/shading/light_params.h>

namespace lodestar::shading {

/// A light's depth map in main memory: rows from the top, reversed depth (nearest = 1).
struct DepthTexels {
    std::span<const float> depth;
    int width = 0, height = 0;
};

/// lightVisibility() of light_visibility.glsl in double precision, for tests: the share of the
/// N×N-texel window about `position` in which the receiver's plane, lifted by one texel, is not
/// behind the map. Empty texels (0) hide nothing, and windows that reach over the map's edge are
/// lit. `taps`: N ≥ 1. `faceNormal`: world, unit length.
double lightVisibilityReference(const shared::GpuLightView&, const DepthTexels&, int taps,
                                glm::dvec3 position, glm::dvec3 faceNormal);

/// skyVisibility() of coarse.comp in double precision: `maps` has one map for each of the
/// light's sky views.
double skyVisibilityReference(const shared::LightParams&, std::span<const DepthTexels> maps,
                              glm::dvec3 position, glm::dvec3 faceNormal, glm::dvec3 normal);

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_SKY_GLSL
#define LS_SKY_GLSL
#include "light_params.h"
#include "../shared/octahedral.h"

/// Irradiance of the sky on a surface facing `n` (Ramamoorthi & Hanrahan 2001).
vec3 skyIrradiance(LightParams light, vec3 n) {
    return max(light.irradiance[0] + light.irradiance[1] * n.y + light.irradiance[2] * n.z +
                   light.irradiance[3] * n.x + light.irradiance[4] * (n.x * n.y) +
                   light.irradiance[5] * (n.y * n.z) +
                   light.irradiance[6] * (3 * n.z * n.z - 1) + light.irradiance[7] * (n.x * n.z) +
                   light.irradiance[8] * (n.x * n.x - n.y * n.y),
               vec3(0));
}

/// The sky as seen in direction `d`, blurred for `roughness`. The map's middle is straight up.
vec3 skyRadiance(sampler2D sky, uint levels, vec3 d, float roughness) {
    const vec2 uv = octahedralEncode(vec3(d.x, d.z, d.y)) * 0.5 + 0.5;
    return textureLod(sky, uv, roughness * float(levels - 1)).rgb;
}

#endif

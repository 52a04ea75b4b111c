// SPDX-License-Identifier: Apache-2.0
#ifndef LS_SKY_GLSL
#define LS_SKY_GLSL
#include "light_params.h"
#include "../shared/octahedral.h"
#include "../visibility/view_params.h"

/// Irradiance of the sky on a surface facing `n`, from LightParams::irradiance (Ramamoorthi &
/// Hanrahan 2001).
vec3 skyIrradiance(vec3 sh[9], vec3 n) {
    return max(sh[0] + sh[1] * n.y + sh[2] * n.z +
                   sh[3] * n.x + sh[4] * (n.x * n.y) +
                   sh[5] * (n.y * n.z) +
                   sh[6] * (3 * n.z * n.z - 1) + sh[7] * (n.x * n.z) +
                   sh[8] * (n.x * n.x - n.y * n.y),
               vec3(0));
}

/// The sky as seen in direction `d`, blurred for `roughness`. The map's middle is straight up.
vec3 skyRadiance(sampler2D sky, uint levels, vec3 d, float roughness) {
    const vec2 uv = octahedralEncode(vec3(d.x, d.z, d.y)) * 0.5 + 0.5;
    return textureLod(sky, uv, roughness * float(levels - 1)).rgb;
}

const float kSunCosine = 0.99996;  // half of its half-degree disc

vec3 sunDisc(vec3 direction, vec3 toSun, vec3 illuminance) {
    return 40 * illuminance * smoothstep(kSunCosine - 2e-5, kSunCosine, dot(direction, toSun));
}

/// Radiance past all surfaces, and the share that the tone map gives its curve: sky and sun, or the
/// backdrop, which shows as it was given.
vec4 pastSurfaces(vec3 sky, vec3 direction, vec3 toSun, vec3 illuminance) {
    return vec4(sky + sunDisc(direction, toSun, illuminance), 1);
}
vec4 pastSurfaces(vec3 backdrop, float exposure) { return vec4(backdrop / exposure, 0); }

/// From the eye to what it sees there, of view depth 1.
vec3 rayThrough(ViewParams view, vec2 ndc) {
    return transpose(mat3(view.viewFromWorld)) * vec3((ndc - view.jitter) / view.clipScale, -1);
}

#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_LIGHT_PARAMS_H
#define LS_LIGHT_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

/// Sun, sky and shadow map of a frame, in a uniform buffer.
struct LightParams {
    vec3 toSun;               // world, unit
    vec3 sunIlluminance;      // linear rgb at normal incidence
    vec3 irradiance[9];       // of the sky: spherical harmonics, cosine lobe and basis constants in
    vec3 irradianceSlope[3];  // its first-order part alone: change along world x, y, z
    mat4 shadowFromWorld;     // world → (texel u, texel v, depth, 1); affine
    vec3 shadowRight, shadowUp;  // light view axes, world; toSun is the third
    float shadowTexel;           // size of a texel [scene units]
    float shadowDepthScale;      // depth units per scene unit towards the sun
    uint shadowTaps;             // N of the N×N PCF; 0 = no shadow
    uint lightCount;             // punctual lights
    uint skyLevels;              // mip levels of the sky map: roughness 0 … 1
    float exposure;              // multiplies radiance before the tone map
};

LS_NAMESPACE_END
#endif

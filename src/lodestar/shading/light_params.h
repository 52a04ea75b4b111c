// SPDX-License-Identifier: Apache-2.0
#ifndef LS_LIGHT_PARAMS_H
#define LS_LIGHT_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_MAX_SHADOW_TAPS = 128u;  // N of the N×N PCF
const uint LS_MAX_SKY_VIEWS = 16;

/// How a parallel light sees the scene: an orthographic depth map, nearest to the light = 1.
struct GpuLightView {
    vec4 u, v, depth;  // of the map, in texels and depth units: affine in (world, 1)
    vec3 toLight;      // world, unit
    float weight;      // of a view of the sky: its luminance
    float bias;        // depth units in the width of a texel
    float planeScale;  // turns (normal · u, normal · v) / (normal · toLight) into depth per texel
    uint size;         // texels a side: a corner of what may be a larger image
};

/// Sun, sky and their depth maps, in a uniform buffer.
struct LightParams {
    vec3 toSun;            // world, unit
    vec3 sunIlluminance;   // linear rgb at normal incidence
    vec3 irradiance[9];    // of the sky: spherical harmonics, cosine lobe and basis constants in
    uint shadowTaps;       // N of the N×N PCF of the sun; 0 = no shadow
    uint skyViewCount;     // views[1] … views[skyViewCount]; 0 = the sky is seen from everywhere
    uint skyTaps;          // N of the N×N PCF of each
    uint noiseOctaves;     // of the procedural pattern; 0 = none
    uint noiseWarps;       // times that pattern warps its own domain
    float noiseFrequency;  // cells of its first octave per scene unit
    uint lightCount;       // punctual lights
    uint skyLevels;        // mip levels of the sky map: roughness 0 … 1
    float exposure;        // multiplies radiance before the tone map
    float perLux;   // multiplies punctual and emissive light, which files give in lux and nit
    vec3 backdrop;  // linear display colour past all surfaces, where the sky is not shown
    GpuLightView views[LS_MAX_SKY_VIEWS + 1];  // the sun's, then those of the sky
};

LS_NAMESPACE_END
#endif

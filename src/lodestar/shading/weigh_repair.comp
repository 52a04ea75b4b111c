// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/gpu_types.h"
#include "../shared/color.glsl"
#include "../upsample/upsample_params.h"
#include "../visibility/view_params.h"
#include "brdf.glsl"
#include "coarse_params.h"
#include "light_params.h"
#include "sky.glsl"
#include "terms_effect.glsl"
#include "weigh_repair_params.h"

// Ranks the listed pixels anew, by what wrong terms would do to the picture: a pixel that the sun
// does not light is no worse for a wrong shadow. A fixed number of threads walks the list.
layout(local_size_x = 64) in;

layout(binding = 0, scalar) uniform View { ViewParams view; };
layout(binding = 1, scalar) uniform Light { LightParams light; };
layout(binding = 2) uniform usampler2D surfaceMaterial;
layout(binding = 3, scalar) readonly buffer Header { RepairHeader repair; };
layout(binding = 4, scalar) buffer Listed { uint listed[]; };
layout(push_constant, scalar) uniform Push { WeighRepairParams params; };

/// Luminance of the display code of a radiance.
float shown(vec3 radiance) {
    return dot(srgbFromLinear(acesFilmic(radiance * light.exposure)), vec3(0.2126, 0.7152, 0.0722));
}

/// How far the terms can move what the display shows of a pixel, 0 … 1. The sky that it mirrors is
/// as blurred as a diffuse surface sees it.
float reachOfTerms(ivec2 pixel) {
    const uvec4 material = texelFetch(surfaceMaterial, pixel, 0);
    if ((material.y >> 16 & LS_MATERIAL_UNLIT) != 0) return 0;
    const vec2 ndc = (vec2(pixel) + 0.5) / vec2(params.fullSize) * 2 - 1;
    const Surface s = surfaceOf(material, 1, -normalize(rayThrough(view, ndc)));
    const vec3 sun = reflected(s, light.toSun) * light.sunIlluminance;
    const vec3 mirrored = skyIrradiance(light.irradiance, reflect(-s.toEye, s.normal)) / 3.14159265;
    const float open = unpackUnorm4x8(material.x).a;
    const vec3 sky = open * reflectedSky(s, skyIrradiance(light.irradiance, s.normal), mirrored);
    const vec3 most = sun + sky;
    const bool shadow = (params.terms & LS_TERM_SHADOW) != 0 && light.shadowTaps > 0;
    const bool occlusion = (params.terms & LS_TERM_AO) != 0 && light.skyViewCount > 0;
    const bool noise = (params.terms & LS_TERM_NOISE) != 0 && light.noiseOctaves > 0;
    const vec3 least = (noise ? veins(0) : 1) *
                       ((shadow ? 0 : 1) * sun + (occlusion ? fromSkyThatIs(0) : 1) * sky);
    return shown(most) - shown(least);
}

void main() {
    const uint threads = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < repair.listed; i += threads) {
        const uint index = listed[i] & ((1u << LS_REPAIR_INDEX_BITS) - 1);
        const float rank = (float(listed[i] >> LS_REPAIR_INDEX_BITS) + 0.5) / LS_REPAIR_BINS;
        const ivec2 pixel = ivec2(index % params.fullSize.x, index / params.fullSize.x);
        // Most products are small: by their roots they spread over the bins.
        const float weighed = sqrt(rank * clamp(reachOfTerms(pixel), 0, 1));
        listed[i] = index | uint(weighed * LS_REPAIR_BINS) << LS_REPAIR_INDEX_BITS;
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// The picture on grid B, in layers: one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kDownsampled = 0;  // 1: `color` lies on B, with its CoC in w

layout(binding = 0) uniform sampler2D color;      // grid O
layout(binding = 1) uniform sampler2D depth;      // grid O
layout(binding = 2, r32f) uniform image2D depthB;  // read; written where downsampled
layout(binding = 3, rgba32ui) writeonly uniform uimage2D outLayers;
layout(push_constant, scalar) uniform Push { DofParams params; };

vec2 centreOnO(ivec2 texel) {
    return min((vec2(texel) + 0.5) * params.grid.rate, vec2(params.grid.fullSize) - 0.5);
}

/// The representative's colour: the mean of those of four pixels of the texel (and the middle one,
/// should none do) that show what it shows, by their depth.
vec3 representativeColor(ivec2 texel, float z) {
    const vec2 centre = centreOnO(texel), r = params.grid.rate;
    const vec2 last = vec2(params.grid.fullSize) - 1;
    vec4 sum = vec4(texelFetch(color, ivec2(centre), 0).rgb, 1) * 1e-3;
    for (int i = 0; i < 4; ++i) {
        // A square on its corner: no two in a row or column.
        const vec2 o = vec2(i == 0 ? -0.125 : i == 1 ? 0.375 : i == 2 ? 0.125 : -0.375,
                            i == 0 ? -0.375 : i == 1 ? -0.125 : i == 2 ? 0.375 : 0.125);
        const ivec2 at = ivec2(clamp(centre + o * r, vec2(0), last));
        const float tapZ = texelFetch(depth, at, 0).x;
        const float w = abs(tapZ - z) <= 0.05 * z ? 1 : 0;
        sum += w * vec4(texelFetch(color, at, 0).rgb, 1);
    }
    return sum.rgb / sum.w;
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    if (kDownsampled != 0) {
        const vec4 c = texelFetch(color, texel, 0);
        imageStore(depthB, texel, vec4(texelFetch(depth, ivec2(centreOnO(texel)), 0).x));
        imageStore(outLayers, texel, packLayers(layersOf(c.rgb, c.w)));
        return;
    }
    const float z = imageLoad(depthB, texel).x;
    imageStore(outLayers, texel,
               packLayers(layersOf(representativeColor(texel, z), cocOf(params, z))));
}

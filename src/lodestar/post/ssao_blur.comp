// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/octahedral.h"
#include "../upsample/coarse_texel.glsl"
#include "../visibility/view_params.h"
#include "ssao_params.h"

// The mean of the nine turns, over what lies near the texel's own plane: one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, scalar) uniform View { ViewParams view; };
layout(binding = 1) uniform usampler2D normal;
layout(binding = 2) uniform usampler2D occlusion;                       // packCoarse, in w
layout(binding = 3, rgba32ui) writeonly uniform uimage2D outOcclusion;  // the same
layout(push_constant, scalar) uniform Push { SsaoParams params; };

#include "effective.glsl"

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    uvec4 own = texelFetch(occlusion, texel, 0);
    const float z = coarseDepth(own);
    const vec3 n = unpackNormal(texelFetch(normal, texel, 0).x);
    const vec3 c = viewPoint(texel, z);
    float sum = 0, weights = 1e-6;
    for (int i = 0; i < 9; ++i) {
        const ivec2 at = clampToB(texel + ivec2(i % 3, i / 3) - 1);
        const uvec4 tap = texelFetch(occlusion, at, 0);
        const float tapZ = coarseDepth(tap);
        const float apart = abs(dot(n, viewPoint(at, tapZ) - c));
        const float w = tapZ > 0 ? max(1 - 2 * apart / params.radius, 0) : 0;
        sum += w * coarseTerms(tap).w;
        weights += w;
    }
    const float mean = z > 0 ? clamp(params.strength * sum / weights, 0, 1) : 0;
    own.y = packHalf2x16(vec2(0, mean));
    imageStore(outOcclusion, texel, own);
}

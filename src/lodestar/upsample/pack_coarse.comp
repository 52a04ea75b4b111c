// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/octahedral.h"
#include "coarse_texel.glsl"

// One thread a texel of grid S.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D terms;
layout(binding = 1) uniform sampler2D depth;
layout(binding = 2) uniform usampler2D normal;
layout(constant_id = 0) const uint kYang = 0;

layout(binding = 3, rgba32ui) writeonly uniform uimage2D coarse;

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, imageSize(coarse)))) return;
    const float z = texelFetch(depth, texel, 0).x;
    const vec3 n = z > 0 ? unpackNormal(texelFetch(normal, texel, 0).x) : vec3(0, 0, 1);
    const vec4 values = texelFetch(terms, texel, 0);
    // Radiance has no end: 8 bits hold c / (1 + c), in steps of its root.
    const vec4 coded = sqrt(values / (1 + values));
    const vec4 eight = round(clamp(coded, 0, 1) * 255) / 255;
    const vec4 squared = min(eight * eight, 0.999);
    const uvec4 lossy = packCoarseYang(vec4(0), n, z);
    const vec4 kept = squared / (1 - squared);
    imageStore(coarse, texel,
               kYang != 0 ? uvec4(packHalf2x16(kept.xy), packHalf2x16(kept.zw), lossy.zw)
                          : packCoarse(values, n, z));
}

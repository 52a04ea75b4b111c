// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/octahedral.h"
#include "coarse_texel.glsl"

// One thread a texel of grid S.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D terms;
layout(binding = 1) uniform sampler2D depth;
layout(binding = 2) uniform usampler2D normal;
layout(binding = 3, rgba32ui) writeonly uniform uimage2D coarse;

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, imageSize(coarse)))) return;
    const float z = texelFetch(depth, texel, 0).x;
    const vec3 n = z > 0 ? unpackNormal(texelFetch(normal, texel, 0).x) : vec3(0, 0, 1);
    imageStore(coarse, texel, packCoarse(texelFetch(terms, texel, 0), n, z));
}

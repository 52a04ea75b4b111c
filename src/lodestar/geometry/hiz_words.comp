// SPDX-License-Identifier: Apache-2.0
#version 460
#include "cull_params.h"

// The finest level, as in hiz.comp, of what was captured in compute: words of id and depth, row by row.
layout(local_size_x = 64) in;

layout(binding = 0) uniform usamplerBuffer words;
layout(binding = 1, scalar) writeonly buffer Pyramid { float pyramid[]; };
layout(push_constant, scalar) uniform Push { HizParams params; };

#include "hiz.glsl"

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, 64, gl_LocalInvocationID.x);
    if (index >= params.to.x * params.to.y) return;
    const ivec4 below = pixelsBelow(ivec2(index % params.to.x, index / params.to.x));
    const ivec2 last = ivec2(params.from) - 1;
    uint least = 0x7f800000u;  // depths are not negative: their bits are ordered as they are
    for (int y = below.y; y < below.w; ++y)
        for (int x = below.x; x < below.z; ++x)
            least = min(least,
                        texelFetch(words, min(y, last.y) * int(params.from.x) + min(x, last.x)).y);
    pyramid[params.toOffset + index] = uintBitsToFloat(least);
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "cull_params.h"

// One thread a texel of the finest level: the farthest depth below it, which in reversed depth is the
// least. A level is half as large as the one below, rounded up, so that every pixel is under exactly one
// texel of each level and none reaches past the picture.
layout(local_size_x = 64) in;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1, scalar) writeonly buffer Pyramid { float pyramid[]; };
layout(push_constant, scalar) uniform Push { HizParams params; };

#include "hiz.glsl"

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, 64, gl_LocalInvocationID.x);
    if (index >= params.to.x * params.to.y) return;
    const ivec4 below = pixelsBelow(ivec2(index % params.to.x, index / params.to.x));
    const ivec2 last = ivec2(params.from) - 1;
    float least = 1e30;
    for (int y = below.y; y < below.w; ++y)
        for (int x = below.x; x < below.z; ++x)
            least = min(least, texelFetch(depth, min(ivec2(x, y), last), 0).x);
    pyramid[params.toOffset + index] = least;
}

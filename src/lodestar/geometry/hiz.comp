// SPDX-License-Identifier: Apache-2.0
#version 460
#include "cull_params.h"

// One thread a texel of a level: the farthest depth below it, which in reversed depth is the least.
// A level is half as large as the one below, rounded up, so that every pixel is under exactly one
// texel of each level and none reaches past the picture.
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint kFirst = 0;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform samplerBuffer finer;
layout(binding = 2, scalar) writeonly buffer Pyramid { float pyramid[]; };
layout(push_constant, scalar) uniform Push { HizParams params; };

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, 64, gl_LocalInvocationID.x);
    if (index >= params.to.x * params.to.y) return;
    const ivec2 at = ivec2(index % params.to.x, index / params.to.x);
    const ivec2 last = ivec2(params.from) - 1;
    float least = 1e30;
    if (kFirst != 0) {
        // Every pixel of the depth image that lies below the texel in part.
        const vec2 slack = vec2(equal(params.scale, vec2(1))) * -1.0 / 64 + 1.0 / 64;
        const ivec2 begin = ivec2(max(vec2(4 * at) * params.scale - slack, 0));
        const ivec2 end = ivec2(ceil(vec2(4 * at + 4) * params.scale + slack));
        for (int y = begin.y; y < end.y; ++y)
            for (int x = begin.x; x < end.x; ++x)
                least = min(least, texelFetch(depth, min(ivec2(x, y), last), 0).x);
    } else {
        for (int y = 0; y < 2; ++y)
            for (int x = 0; x < 2; ++x) {
                const ivec2 p = min(2 * at + ivec2(x, y), last);
                least = min(least, texelFetch(finer, int(params.fromOffset) +
                                                         p.y * int(params.from.x) + p.x).x);
            }
    }
    pyramid[params.toOffset + index] = least;
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "cull_params.h"

// One thread a texel of a level: the least of the four below it.
layout(local_size_x = 64) in;

layout(binding = 0) uniform samplerBuffer finer;
layout(binding = 1, scalar) writeonly buffer Pyramid { float pyramid[]; };
layout(push_constant, scalar) uniform Push { HizParams params; };

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, 64, gl_LocalInvocationID.x);
    if (index >= params.to.x * params.to.y) return;
    const ivec2 at = ivec2(index % params.to.x, index / params.to.x);
    const ivec2 last = ivec2(params.from) - 1;
    float least = 1e30;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) {
            const ivec2 p = min(2 * at + ivec2(x, y), last);
            least = min(least,
                        texelFetch(finer, int(params.fromOffset) + p.y * int(params.from.x) + p.x).x);
        }
    pyramid[params.toOffset + index] = least;
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "max_depth_params.h"

// One step of a chain: of 2 × 2 texels the farthest, one thread a texel of the smaller picture.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform usampler2D normal;
layout(binding = 2, r32f) writeonly uniform image2D outDepth;
layout(binding = 3, r32ui) writeonly uniform uimage2D outNormal;
layout(push_constant, scalar) uniform Push { MaxDepthParams params; };

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2((params.size + 1) / 2)))) return;
    const ivec2 last = ivec2(params.size) - 1;
    float most = 0;
    ivec2 at = min(2 * texel, last);
    bool background = false;  // 0, and farther than all else
    for (int i = 0; i < 4; ++i) {
        const ivec2 tap = min(2 * texel + ivec2(i & 1, i >> 1), last);
        const float z = texelFetch(depth, tap, 0).x;
        background = background || z <= 0;
        at = z > most ? tap : at;
        most = max(most, z);
    }
    imageStore(outDepth, texel, vec4(background ? 0 : most));
    imageStore(outNormal, texel, texelFetch(normal, at, 0));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// One step of the chain that the thesis compares with: of 2 × 2 texels the mean, weighed by their
// circles of confusion. One thread a texel of the smaller picture.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D color;  // later steps: its CoC in w
layout(binding = 1) uniform sampler2D depth;  // of the first step
layout(binding = 2, rgba16f) writeonly uniform image2D outColor;
layout(push_constant, scalar) uniform Push { DofDownParams params; };

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2((params.size + 1) / 2)))) return;
    const ivec2 last = ivec2(params.size) - 1;
    vec4 sum = vec4(0);
    float coc = 0;
    for (int i = 0; i < 4; ++i) {
        const ivec2 tap = min(2 * texel + ivec2(i & 1, i >> 1), last);
        const vec4 c = texelFetch(color, tap, 0);
        const float own =
            params.first != 0 ? cocOf(params.lens, texelFetch(depth, tap, 0).x) : c.w;
        const float w = abs(own) + 0.01;
        sum += w * vec4(min(c.rgb, vec3(6e4)), 1);
        coc += w * own;
    }
    imageStore(outColor, texel, vec4(sum.rgb, coc) / sum.w);
}

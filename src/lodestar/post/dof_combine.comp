// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// The blurred pictures over the sharp one, one thread a pixel of O.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D depth;     // grid O
layout(binding = 1) uniform usampler2D blurred;  // grid B: rgb of the background, guide; rgba near
layout(binding = 2, rgba16f) uniform image2D color;
layout(push_constant, scalar) uniform Push { DofParams params; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.grid.fullSize)))) return;
    const float z = texelFetch(depth, pixel, 0).x;
    const vec2 at = (vec2(pixel) + 0.5) / params.grid.rate - 0.5, base = floor(at), f = at - base;
    const ivec2 last = ivec2(params.grid.size) - 1;
    const float coc = cocOf(params, z), guide = guideOf(coc);

    // Background: a tent, and the circle of confusion in the place of upsample.comp's depth and
    // normal, which would give what is blurred its edges back. Foreground: it lies over all.
    vec3 behind[4];
    float w[4], e[4];
    vec4 near = vec4(0);
    float least = 3e38;
    for (int i = 0; i < 4; ++i) {
        const ivec2 o = ivec2(i & 1, i >> 1);
        const uvec4 t = texelFetch(blurred, clamp(ivec2(base) + o, ivec2(0), last), 0);
        const vec2 blueGuide = unpackHalf2x16(t.y);
        behind[i] = vec3(unpackHalf2x16(t.x), blueGuide.x);
        w[i] = (o.x == 0 ? 1 - f.x : f.x) * (o.y == 0 ? 1 - f.y : f.y);
        e[i] = params.cocFalloff * (guide - blueGuide.y) * (guide - blueGuide.y);
        if (w[i] > 1e-4) least = min(least, e[i]);
        near += w[i] * vec4(unpackHalf2x16(t.z), unpackHalf2x16(t.w));
    }
    vec4 sum = vec4(0);
    for (int i = 0; i < 4; ++i)
        sum += w[i] * exp2(clamp(least - e[i], -126.0, 0.0)) * vec4(behind[i], 1);

    const vec4 own = imageLoad(color, pixel);
    // Where the foreground is much blurred, what is left of its sharp picture must not show
    // through: what is around it does.
    const float t = coc > 0 ? min(3 * coc, 1) : clamp(-6 * coc - 1, 0, 1);
    const vec3 under = mix(own.rgb, sum.rgb / sum.w, t);
    imageStore(color, pixel, vec4(under * (1 - near.a) + near.rgb, own.a));
}

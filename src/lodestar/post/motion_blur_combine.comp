// SPDX-License-Identifier: Apache-2.0
#version 460
#include "motion_blur_params.h"
#include "motion_blur_texel.glsl"

// Adds what was gathered on B to the picture, one thread a pixel of O.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kBilateral = 1;

layout(binding = 0) uniform sampler2D depth;     // grid O
layout(binding = 1) uniform usampler2D moving;  // grid B
layout(binding = 2) uniform sampler2D blur;      // grid B
layout(binding = 3, rgba16f) uniform image2D color;
layout(push_constant, scalar) uniform Push { MotionBlurParams params; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.grid.fullSize)))) return;
    const float own = texelFetch(depth, pixel, 0).x, z = own > 0 ? own : 3e38;
    const vec2 at = (vec2(pixel) + 0.5) / params.grid.rate - 0.5, base = floor(at), f = at - base;
    const ivec2 last = ivec2(params.grid.size) - 1;
    vec4 sum = vec4(0);
    float weights = 0;
    for (int i = 0; i < 4; ++i) {
        const ivec2 o = ivec2(i & 1, i >> 1);
        const ivec2 tap = clamp(ivec2(base) + o, ivec2(0), last);
        float w = (o.x == 0 ? 1 - f.x : f.x) * (o.y == 0 ? 1 - f.y : f.y);
        if (kBilateral != 0) {
            const float tapZ = uintBitsToFloat(texelFetch(moving, tap, 0).w);
            w *= abs(tapZ - z) <= 0.05 * z ? 1 : 1e-3;
        }
        sum += w * texelFetch(blur, tap, 0);
        weights += w;
    }
    sum /= weights;
    if (sum.a > 0.9999) return;  // nothing moves here: not even a rounding
    const vec4 sharp = imageLoad(color, pixel);
    imageStore(color, pixel, vec4(sharp.rgb * sum.a + sum.rgb, sharp.a));
}

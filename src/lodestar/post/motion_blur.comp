// SPDX-License-Identifier: Apache-2.0
#version 460
#include "motion_blur_params.h"
#include "motion_blur_texel.glsl"

// Gathers along the fastest motion around (McGuire et al. 2012), one thread a texel of B. What a
// texel shows itself is left to grid O: written is what others add, and the share that stays.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2D moving;
layout(binding = 1) uniform sampler2D tiles;
layout(binding = 2, rgba16f) writeonly uniform image2D outBlur;  // rgb added; a: share that stays
layout(push_constant, scalar) uniform Push { MotionBlurParams params; };

/// 1 where `a` is before `b` or as far, 0 where it is well behind.
float before(float a, float b) { return clamp(1 - (a - b) / (0.02 * min(a, b)), 0, 1); }
/// Whether a streak of half length `speed` reaches `distance`.
float reaches(float distance, float speed) {
    return speed < 0.5 ? 0 : 1 - smoothstep(0.95 * speed, 1.05 * speed, distance);
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    const vec2 along = texelFetch(tiles, texel / int(LS_MOTION_TILE), 0).xy;
    const Moving own = unpackMoving(texelFetch(moving, texel, 0));
    const float ownSpeed = length(own.velocity);
    const ivec2 last = ivec2(params.grid.size) - 1;
    // Another offset for each texel of 4 × 4, so that taps do not line up.
    const int bayer = ((texel.x ^ texel.y) & 1) << 3 | (texel.y & 1) << 2 |
                      ((texel.x ^ texel.y) & 2) | (texel.y & 2) >> 1;
    const float offset = (float(bayer) + 0.5) / 16;
    const int samples = length(along) >= 0.5 ? int(LS_MOTION_SAMPLES) : 0;

    // Each tap is an instant. While the shutter is open the texel shows there what moves over it,
    // what it uncovers as it moves itself, or what it is.
    vec4 sum = vec4(0);
    for (int i = 0; i < samples; ++i) {
        const float t = 2 * (float(i) + offset) / float(LS_MOTION_SAMPLES) - 1;
        const ivec2 at = clamp(ivec2(floor(vec2(texel) + 0.5 + along * t)), ivec2(0), last);
        const Moving tap = unpackMoving(texelFetch(moving, at, 0));
        const float distance = length(vec2(at - texel));
        const float over = before(tap.depth, own.depth) * reaches(distance, length(tap.velocity));
        const float under = before(own.depth, tap.depth) * reaches(distance, ownSpeed);
        const float w = at == texel ? 0 : max(over, under);
        sum += w * vec4(tap.color, 1);
    }
    sum /= float(LS_MOTION_SAMPLES);
    imageStore(outBlur, texel, vec4(sum.rgb, 1 - sum.a));
}

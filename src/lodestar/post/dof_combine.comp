// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// The blurred pictures over the sharp one, one thread a pixel of O or 2×2 of them.
layout(local_size_x = 8, local_size_y = 8) in;

// Pixels a thread, along each axis. 2 where a texel of B has a multiple of four: centres of texels
// then lie between such blocks, and all four pixels have the same texels around them.
layout(constant_id = 0) const int kSide = 1;

layout(binding = 0) uniform sampler2D depth;     // grid O
layout(binding = 1) uniform usampler2D blurred;  // grid B: rgb of the background, guide; rgba near
layout(binding = 2, rgba16f) uniform image2D color;
layout(push_constant, scalar) uniform Push { DofParams params; };

/// What a texel of B shows.
struct Tap {
    vec3 behind;
    float guide;
    vec4 near;
};

vec2 placeOnB(ivec2 pixel) { return (vec2(pixel) + 0.5) / params.grid.rate - 0.5; }

/// `between`: how far the pixel lies past the first of the 2×2 taps, along each axis.
void blend(ivec2 pixel, Tap taps[4], vec2 between) {
    const float coc = cocOf(params, texelFetch(depth, pixel, 0).x), guide = guideOf(coc);
    // Background: a tent, and the circle of confusion in the place of upsample.comp's depth and
    // normal, which would give what is blurred its edges back. Foreground: it lies over all.
    float w[4], e[4];
    vec4 near = vec4(0);
    float least = 3e38;
    for (int i = 0; i < 4; ++i) {
        w[i] = ((i & 1) == 0 ? 1 - between.x : between.x) * (i < 2 ? 1 - between.y : between.y);
        e[i] = params.cocFalloff * (guide - taps[i].guide) * (guide - taps[i].guide);
        if (w[i] > 1e-4) least = min(least, e[i]);
        near += w[i] * taps[i].near;
    }
    vec4 sum = vec4(0);
    for (int i = 0; i < 4; ++i)
        sum += w[i] * exp2(clamp(least - e[i], -126.0, 0.0)) * vec4(taps[i].behind, 1);

    const vec4 own = imageLoad(color, pixel);
    // Where the foreground is much blurred, what is left of its sharp picture must not show
    // through: what is around it does.
    const float t = coc > 0 ? min(3 * coc, 1) : clamp(-6 * coc - 1, 0, 1);
    const vec3 under = mix(own.rgb, sum.rgb / sum.w, t);
    imageStore(color, pixel, vec4(under * (1 - near.a) + near.rgb, own.a));
}

void main() {
    const ivec2 first = kSide * ivec2(gl_GlobalInvocationID.xy), size = ivec2(params.grid.fullSize);
    if (any(greaterThanEqual(first, size))) return;
    const ivec2 base = ivec2(floor(placeOnB(first))), last = ivec2(params.grid.size) - 1;
    Tap taps[4];
    for (int i = 0; i < 4; ++i) {
        const uvec4 t =
            texelFetch(blurred, clamp(base + ivec2(i & 1, i >> 1), ivec2(0), last), 0);
        const vec2 blueGuide = unpackHalf2x16(t.y);
        taps[i] = Tap(vec3(unpackHalf2x16(t.x), blueGuide.x), blueGuide.y,
                      vec4(unpackHalf2x16(t.z), unpackHalf2x16(t.w)));
    }
    for (int i = 0; i < kSide * kSide; ++i) {
        const ivec2 pixel = first + ivec2(i % kSide, i / kSide);
        if (all(lessThan(pixel, size))) blend(pixel, taps, placeOnB(pixel) - vec2(base));
    }
}

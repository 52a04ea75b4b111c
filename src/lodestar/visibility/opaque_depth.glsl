// SPDX-License-Identifier: Apache-2.0
// How near what is opaque is at any place of the picture: 1 / depth, 0 where there is nothing.
#ifndef LS_OPAQUE_DEPTH_GLSL
#define LS_OPAQUE_DEPTH_GLSL

float nearnessOf(float depth) { return depth > 0 ? 1 / depth : 0; }

/// `at` in pixels of `depths`. Nearness is linear over a plane, so between pixels of one surface it
/// is interpolated and exact; where they show several it is the nearest pixel's.
float opaqueNearness(sampler2D depths, vec2 at, uvec2 size) {
    const ivec2 last = ivec2(size) - 1, base = ivec2(floor(at - 0.5));
    const vec2 f = at - 0.5 - vec2(base);
    float low = 1e30, high = 0, sum = 0;
    for (int i = 0; i < 4; ++i) {
        const ivec2 corner = ivec2(i & 1, i >> 1);
        const float own =
            nearnessOf(texelFetch(depths, clamp(base + corner, ivec2(0), last), 0).x);
        const vec2 share = mix(1 - f, f, vec2(corner));
        low = min(low, own);
        high = max(high, own);
        sum += share.x * share.y * own;
    }
    const float nearest = nearnessOf(texelFetch(depths, clamp(ivec2(at), ivec2(0), last), 0).x);
    return high - low <= 0.1 * high ? sum : nearest;
}

#endif

// SPDX-License-Identifier: Apache-2.0
// Places of grid B. Wants `view` and `params.grid`.
#ifndef LS_EFFECTIVE_GLSL
#define LS_EFFECTIVE_GLSL

/// Where a texel of B is met on O, in pixels.
vec2 centreOnO(ivec2 texel) {
    return min((vec2(texel) + 0.5) * params.grid.rate, vec2(params.grid.fullSize) - 0.5);
}

/// The view-space point that a texel of B shows at linear depth `z`.
vec3 viewPoint(ivec2 texel, float z) {
    const vec2 ndc = centreOnO(texel) / vec2(params.grid.fullSize) * 2 - 1;
    return vec3((ndc - view.jitter) / view.clipScale, -1) * z;
}

ivec2 clampToB(ivec2 texel) { return clamp(texel, ivec2(0), ivec2(params.grid.size) - 1); }

#endif

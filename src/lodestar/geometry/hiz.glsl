// SPDX-License-Identifier: Apache-2.0
// Which pixels a texel of the finest level covers. Include after declaring `params` (HizParams).
#ifndef LS_HIZ_GLSL
#define LS_HIZ_GLSL

/// Every pixel of the depth picture that lies below the texel in part: begin.xy to end.zw, without the
/// end. Pixels beyond the last row and column stand for those.
ivec4 pixelsBelow(ivec2 texel) {
    const vec2 slack = vec2(equal(params.scale, vec2(1))) * -1.0 / 64 + 1.0 / 64;
    const ivec2 first = texel << LS_HIZ_FIRST, end = texel + 1 << LS_HIZ_FIRST;
    return ivec4(max(vec2(first) * params.scale - slack, 0),
                 ceil(vec2(end) * params.scale + slack));
}

#endif

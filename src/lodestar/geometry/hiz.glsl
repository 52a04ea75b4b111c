// SPDX-License-Identifier: Apache-2.0
// Which pixels a texel of the finest level covers. Include after declaring `params` (HizParams).
#ifndef LS_HIZ_GLSL
#define LS_HIZ_GLSL

/// Every pixel of the depth picture that lies below the texel in part: begin.xy to end.zw, without the
/// end. Pixels beyond the last row and column stand for those.
ivec4 pixelsBelow(ivec2 texel) {
    const vec2 slack = vec2(equal(params.scale, vec2(1))) * -1.0 / 64 + 1.0 / 64;
    return ivec4(max(vec2(4 * texel) * params.scale - slack, 0),
                 ceil(vec2(4 * texel + 4) * params.scale + slack));
}

#endif

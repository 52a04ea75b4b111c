// SPDX-License-Identifier: Apache-2.0
// A texel of grid B as motion blur gathers it: colour, velocity and depth in one load.
#ifndef LS_MOTION_BLUR_TEXEL_GLSL
#define LS_MOTION_BLUR_TEXEL_GLSL

struct Moving {
    vec3 color;
    vec2 velocity;  // half of the streak, in texels of B
    float depth;    // linear; the sky is farther than all else
};

uvec4 packMoving(Moving m) {
    return uvec4(packHalf2x16(m.color.rg), packHalf2x16(vec2(m.color.b, 0)),
                 packHalf2x16(m.velocity), floatBitsToUint(m.depth));
}

Moving unpackMoving(uvec4 t) {
    return Moving(vec3(unpackHalf2x16(t.x), unpackHalf2x16(t.y).x), unpackHalf2x16(t.z),
                  uintBitsToFloat(t.w));
}

#endif

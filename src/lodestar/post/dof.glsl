// SPDX-License-Identifier: Apache-2.0
// What the passes of depth of field share.
#ifndef LS_DOF_GLSL
#define LS_DOF_GLSL
#include "dof_params.h"

/// The circle of confusion, −1 … 1: negative before the focus. Depth 0 is infinitely far.
float cocOf(DofParams lens, float z) {
    const float from = z > 0 ? z - lens.focus : 1e30;
    const float coc = min(lens.slope * max(abs(from) - lens.sharp, 0), 1);
    return from > 0 ? coc : lens.thesis != 0 ? 0 : -coc;
}

/// What guides the way back to grid O: what is well out of focus, however far, is one, for there the
/// blur itself goes over edges. The foreground has no say in what is behind it.
float guideOf(float coc) { return min(3 * coc, 1); }

/// What lies at and past the focus, and what lies before it, apart: so that neither side's blur
/// takes colour from over the edge.
struct Layers {
    // Colour times weight, weight: what is out of focus itself counts, what is sharp hardly, and
    // the foreground where there is nothing else. What it hides is so guessed from what is around.
    vec4 far;
    vec3 near;   // colour times cover
    vec2 cover;  // how much of it is blurred foreground; that times its circle of confusion
};

vec4 farWeights(vec4 coc) { return mix(max(coc, 0.02), vec4(1e-4), lessThan(coc, vec4(0))); }
vec4 covers(vec4 coc) { return clamp(-3 * coc, 0, 1); }
vec3 boundedColor(vec3 color) { return min(color, vec3(6e4)); }

Layers layersOf(vec3 color, float coc) {
    const float cover = covers(vec4(coc)).x;
    const vec3 c = boundedColor(color);
    return Layers(vec4(c, 1) * farWeights(vec4(coc)).x, c * cover, vec2(cover, -coc * cover));
}

/// Adds four pixels of one colour, each by its own circle of confusion.
void addFour(inout Layers sum, vec3 color, vec4 coc) {
    const vec4 cover = covers(coc);
    const vec3 c = boundedColor(color);
    sum.far += vec4(c, 1) * dot(farWeights(coc), vec4(1));
    sum.near += c * dot(cover, vec4(1));
    sum.cover += vec2(dot(cover, vec4(1)), -dot(cover, coc));
}

uvec4 packLayers(Layers l) {
    return uvec4(packHalf2x16(l.far.rg), packHalf2x16(l.far.ba), packHalf2x16(l.near.rg),
                 packHalf2x16(vec2(l.near.b, 0)) | packUnorm4x8(vec4(0, 0, l.cover)));
}

Layers unpackLayers(uvec4 t) {
    return Layers(vec4(unpackHalf2x16(t.x), unpackHalf2x16(t.y)),
                  vec3(unpackHalf2x16(t.z), unpackHalf2x16(t.w).x), unpackUnorm4x8(t.w).zw);
}

void add(inout Layers sum, Layers l, float w) {
    sum.far += w * l.far;
    sum.near += w * l.near;
    sum.cover += w * l.cover;
}

#endif

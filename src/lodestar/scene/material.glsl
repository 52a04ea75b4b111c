// SPDX-License-Identifier: Apache-2.0
// Reading a material's textures. The includer defines LS_TEXTURE_BINDING (the binding of the array
// of texture arrays) and may narrow the specialization constants.
#ifndef LS_MATERIAL_GLSL
#define LS_MATERIAL_GLSL
#include "gpu_types.h"

layout(constant_id = 0) const uint kTextureArrays = 8;
layout(constant_id = 1) const uint kUvTransforms = 1;

layout(binding = LS_TEXTURE_BINDING) uniform sampler2DArray sceneTextures[LS_TEXTURE_ARRAYS];

/// A point of a texture, with its change over one pixel.
struct TexturePoint {
    vec2 uv, dx, dy;
};

float wrapped(float x, uint mode, float halfTexel) {
    if (mode == LS_WRAP_MIRROR) return 1 - abs(mod(x, 2) - 1);
    return mode == LS_WRAP_CLAMP ? clamp(x, halfTexel, 1 - halfTexel) : x;
}

/// The sampler always repeats; other wrap modes and nearest filtering are done on the coordinates.
TexturePoint readAs(TexturePoint p, uint reading, vec2 size) {
    const uint wrapU = reading & 3, wrapV = reading >> 2 & 3;
    if ((reading & 16) != 0) p.uv = (floor(p.uv * size) + 0.5) / size;
    p.uv = vec2(wrapped(p.uv.x, wrapU, 0.5 / size.x), wrapped(p.uv.y, wrapV, 0.5 / size.y));
    return p;
}

vec4 sampleArray(uint array, float layer, TexturePoint p, uint reading) {
    vec4 color = vec4(1);
    // One branch for each array the scene has; the constant removes the others.
#define LS_SAMPLE(i)                                                               \
    if (i < kTextureArrays && array == i) {                                        \
        TexturePoint q = p;                                                        \
        if (kUvTransforms != 0) q = readAs(p, reading, textureSize(sceneTextures[i], 0).xy); \
        color = textureGrad(sceneTextures[i], vec3(q.uv, layer), q.dx, q.dy);      \
    }
    LS_SAMPLE(0) LS_SAMPLE(1) LS_SAMPLE(2) LS_SAMPLE(3)
    LS_SAMPLE(4) LS_SAMPLE(5) LS_SAMPLE(6) LS_SAMPLE(7)
#undef LS_SAMPLE
    return color;
}

/// White where the material has no such texture. `p1` is the point in the second UV set.
vec4 sampleTexture(GpuTextureUse use, TexturePoint p0, TexturePoint p1) {
    TexturePoint p = p0;
    if (kUvTransforms != 0) {
        if ((use.reading & 32) != 0) p = p1;
        if ((use.reading & 64) != 0) {
            p = TexturePoint(vec2(dot(use.uRow, vec3(p.uv, 1)), dot(use.vRow, vec3(p.uv, 1))),
                             vec2(dot(use.uRow.xy, p.dx), dot(use.vRow.xy, p.dx)),
                             vec2(dot(use.uRow.xy, p.dy), dot(use.vRow.xy, p.dy)));
        }
    }
    return sampleArray(use.array, float(use.layer), p, use.reading);
}

#endif

// SPDX-License-Identifier: Apache-2.0
// Materials and their textures. The includer defines LS_MATERIAL_BINDING and LS_TEXTURE_BINDING, of
// the materials and of the array of texture arrays.
#ifndef LS_MATERIAL_GLSL
#define LS_MATERIAL_GLSL
#include "gpu_types.h"

layout(constant_id = 0) const uint kUvTransforms = 1;

layout(binding = LS_MATERIAL_BINDING) uniform usamplerBuffer sceneMaterials;
layout(binding = LS_TEXTURE_BINDING) uniform sampler2DArray sceneTextures[LS_TEXTURE_ARRAYS];

GpuMaterial loadMaterial(uint index) {
    const int at = int(index * LS_MATERIAL_WORDS);
    const uvec4 emissive = texelFetch(sceneMaterials, at + 1);
    const vec4 factors = uintBitsToFloat(texelFetch(sceneMaterials, at + 2));
    const uvec4 textures = texelFetch(sceneMaterials, at + 3);
    const uvec4 last = texelFetch(sceneMaterials, at + 4);
    return GpuMaterial(uintBitsToFloat(texelFetch(sceneMaterials, at)),
                       uintBitsToFloat(emissive.xyz), emissive.w, factors.x, factors.y, factors.z,
                       factors.w, textures.x, textures.y, textures.z, textures.w, last.x,
                       uintBitsToFloat(last.y), 0, 0);
}

/// A point of a texture, with its change over one pixel.
struct TexturePoint {
    vec2 uv, dx, dy;
};

/// A fragment's or pixel's place in both UV sets, and whose transforms apply.
struct TexturePlace {
    TexturePoint set0, set1;
    uint material;
};

float wrapped(float x, uint mode, float halfTexel) {
    if (mode == LS_WRAP_REPEAT) return x;
    if (mode == LS_WRAP_MIRROR) x = 1 - abs(mod(x, 2) - 1);
    return clamp(x, halfTexel, 1 - halfTexel);
}

/// The sampler always repeats; other wrap modes and nearest filtering are done on the coordinates.
/// Half a texel of the coarser mip level in use keeps filtering from reaching over the edge.
vec2 readAs(TexturePoint p, uint reading, vec2 size) {
    vec2 uv = p.uv;
    if ((reading & LS_READ_NEAREST) != 0) uv = (floor(uv * size) + 0.5) / size;
    const vec2 dx = p.dx * size, dy = p.dy * size;
    const float texels = sqrt(max(max(dot(dx, dx), dot(dy, dy)), 1));  // a pixel covers
    const vec2 halfTexel = min(0.5 * exp2(ceil(log2(texels) - 0.01)) / size, 0.5);
    return vec2(wrapped(uv.x, reading & 3, halfTexel.x),
                wrapped(uv.y, reading >> 2 & 3, halfTexel.y));
}

/// White where the material has no such texture. `use` is one of the material's texture words,
/// `which` its number (0 … 4), `among` a bit for each array it may lie in (a constant of the scene).
vec4 sampleTexture(uint use, uint which, TexturePlace place, uint among) {
    TexturePoint p = place.set0;
    const uint reading = use >> LS_READING_SHIFT;
    if (kUvTransforms != 0 && use != LS_NO_TEXTURE) {
        if ((reading & LS_READ_UV1) != 0) p = place.set1;
        if ((reading & LS_READ_TRANSFORMED) != 0) {
            const int at = int(place.material * LS_MATERIAL_WORDS + 5 + 2 * which);
            const vec3 u = uintBitsToFloat(texelFetch(sceneMaterials, at).xyz);
            const vec3 v = uintBitsToFloat(texelFetch(sceneMaterials, at + 1).xyz);
            p = TexturePoint(vec2(dot(u, vec3(p.uv, 1)), dot(v, vec3(p.uv, 1))),
                             vec2(dot(u.xy, p.dx), dot(v.xy, p.dx)),
                             vec2(dot(u.xy, p.dy), dot(v.xy, p.dy)));
        }
    }
    vec4 color = vec4(1);
    const uint array = use == LS_NO_TEXTURE ? LS_NO_TEXTURE : use & LS_ARRAY_MASK;
    const float layer = float(use >> LS_LAYER_SHIFT & LS_LAYER_MASK);
    // There is no descriptor indexing on the driver floor, and some drivers run every branch of a
    // choice: the constant leaves only those that can occur.
#define LS_SAMPLE(i)                                                                \
    if ((among & 1u << i) != 0 && array == i) {                                     \
        vec2 uv = p.uv;                                                             \
        if (kUvTransforms != 0)                                                     \
            uv = readAs(p, reading, vec2(textureSize(sceneTextures[i], 0).xy));    \
        color = textureGrad(sceneTextures[i], vec3(uv, layer), p.dx, p.dy);         \
    }
    LS_SAMPLE(0) LS_SAMPLE(1) LS_SAMPLE(2) LS_SAMPLE(3)
    LS_SAMPLE(4) LS_SAMPLE(5) LS_SAMPLE(6) LS_SAMPLE(7)
#undef LS_SAMPLE
    return color;
}

#endif

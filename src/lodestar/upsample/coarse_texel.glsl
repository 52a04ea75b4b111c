// SPDX-License-Identifier: Apache-2.0
// A texel of grid S: four terms, normal and depth in 16 bytes, so that a tap is one load.
#ifndef LS_COARSE_TEXEL_GLSL
#define LS_COARSE_TEXEL_GLSL

/// View-space normal without foreshortening: (nx/nz, ny/nz), the third component being 1
/// (Toler-Franklin et al. 2007). Bounded, since smooth normals may turn away from the eye.
vec2 foreshortened(vec3 n) { return n.xy / max(n.z, 0.05); }

uvec4 packCoarse(vec4 terms, vec3 viewNormal, float depth) {
    return uvec4(packHalf2x16(terms.xy), packHalf2x16(terms.zw), floatBitsToUint(depth),
                 packHalf2x16(foreshortened(viewNormal)));
}

/// What is left of a texel in the paper's single RGBA16 target: four values in 8 bits each, depth
/// in 16 (here a half: scale-free), x and y of the normal in 8 bits each.
uvec4 packCoarseYang(vec4 terms, vec3 viewNormal, float depth) {
    const vec4 eight = round(clamp(terms, 0, 1) * 255) / 255;
    const vec2 n = round(clamp(viewNormal.xy, -1, 1) * 127) / 127;
    const float half16 = unpackHalf2x16(packHalf2x16(vec2(min(depth, 65504), 0))).x;
    return packCoarse(eight, vec3(n, sqrt(max(1 - dot(n, n), 0))), half16);
}

vec4 coarseTerms(uvec4 texel) { return vec4(unpackHalf2x16(texel.x), unpackHalf2x16(texel.y)); }
float coarseDepth(uvec4 texel) { return uintBitsToFloat(texel.z); }
vec2 coarseNormal(uvec4 texel) { return unpackHalf2x16(texel.w); }

#endif

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

vec4 coarseTerms(uvec4 texel) { return vec4(unpackHalf2x16(texel.x), unpackHalf2x16(texel.y)); }
float coarseDepth(uvec4 texel) { return uintBitsToFloat(texel.z); }
vec2 coarseNormal(uvec4 texel) { return unpackHalf2x16(texel.w); }

#endif

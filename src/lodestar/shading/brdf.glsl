// SPDX-License-Identifier: Apache-2.0
// glTF's metallic-roughness material: Lambert + GGX (Walter et al. 2007) with height-correlated
// Smith masking (Heitz 2014) and Schlick's Fresnel.
#ifndef LS_BRDF_GLSL
#define LS_BRDF_GLSL
#include "../shared/octahedral.h"

struct Surface {
    vec3 diffuse;   // albedo of the diffuse lobe, which gets what is not reflected
    vec3 f0;        // reflectance at normal incidence
    vec3 normal, toEye;
    float alpha;    // roughness²
    float perceptualRoughness;
    float nDotV;
};

/// Of a texel of the material image, whose albedo is multiplied by `pattern`.
Surface surfaceOf(uvec4 material, float pattern, vec3 toEye) {
    const vec3 rootOfAlbedo = unpackUnorm4x8(material.x).rgb;
    const vec3 albedo = rootOfAlbedo * rootOfAlbedo * pattern;
    const vec2 roughMetal = unpackUnorm4x8(material.y).xy;
    const float roughness = roughMetal.x, metallic = roughMetal.y;
    const vec3 normal = unpackNormal(material.z);
    Surface s;
    s.diffuse = albedo * (1 - metallic);
    s.f0 = mix(vec3(0.04), albedo, metallic);
    s.normal = normal;
    s.toEye = toEye;
    s.perceptualRoughness = clamp(roughness, 0.045, 1);
    s.alpha = s.perceptualRoughness * s.perceptualRoughness;
    s.nDotV = max(abs(dot(normal, toEye)), 1e-3);
    return s;
}

/// Radiance towards the eye for unit illuminance from `toLight`: BRDF · cos.
vec3 reflected(Surface s, vec3 toLight) {
    const float nDotL = dot(s.normal, toLight);
    if (nDotL <= 0) return vec3(0);
    const vec3 h = normalize(s.toEye + toLight);
    const float nDotH = clamp(dot(s.normal, h), 0, 1);
    const float vDotH = clamp(dot(s.toEye, h), 0, 1);
    const float a2 = s.alpha * s.alpha;
    const float d = (nDotH * a2 - nDotH) * nDotH + 1;
    const float distribution = a2 / (3.14159265 * d * d);
    const float masking = 0.5 / (nDotL * sqrt(s.nDotV * s.nDotV * (1 - a2) + a2) +
                                 s.nDotV * sqrt(nDotL * nDotL * (1 - a2) + a2));
    const float g = 1 - vDotH, g2 = g * g;
    const vec3 fresnel = s.f0 + (1 - s.f0) * (g2 * g2 * g);
    return ((1 - fresnel) * s.diffuse / 3.14159265 + distribution * masking * fresnel) * nDotL;
}

/// Share of a prefiltered environment that is reflected: the split-sum scale and bias as fitted by
/// Karis 2014 (mobile).
vec3 environmentReflectance(Surface s) {
    const vec4 r = s.perceptualRoughness * vec4(-1, -0.0275, -0.572, 0.022) +
                   vec4(1, 0.0425, 1.04, -0.04);
    const float a004 = min(r.x * r.x, exp2(-9.28 * s.nDotV)) * r.x + r.y;
    const vec2 ab = vec2(-1.04, 1.04) * a004 + r.zw;
    return s.f0 * ab.x + ab.y;
}

/// What a surface sends to the eye of a sky: `irradiance` that comes to it, and the `seen` radiance
/// in the direction that it mirrors.
vec3 reflectedSky(Surface s, vec3 irradiance, vec3 seen) {
    const vec3 mirrored = environmentReflectance(s);
    return (1 - mirrored) * s.diffuse * irradiance / 3.14159265 + mirrored * seen;
}

#endif

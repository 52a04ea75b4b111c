// SPDX-License-Identifier: Apache-2.0
// The cheap, detailed shading of a pixel of grid O, joined with its terms.
#ifndef LS_COMBINE_GLSL
#define LS_COMBINE_GLSL
#include "../scene/gpu_types.h"
#include "../visibility/view_params.h"
#include "brdf.glsl"
#include "sky.glsl"
#include "terms_effect.glsl"

layout(constant_id = 0) const uint kEmissive = 1;
layout(constant_id = 1) const uint kUnlit = 1;
layout(constant_id = 2) const uint kPunctualLights = 1;
layout(constant_id = 3) const uint kBackdrop = 0;  // 1: one colour in the place of the sky

layout(binding = 0, scalar) uniform View {
    ViewParams view;
};
layout(binding = 1, scalar) uniform Light {
    LightParams light;
};
layout(binding = 2) uniform sampler2D surfaceDepth;
layout(binding = 3) uniform usampler2D surfaceMaterial;
layout(binding = 4) uniform sampler2D surfaceEmissive;
layout(binding = 5) uniform sampler2D sky;
layout(binding = 6, scalar) readonly buffer Lights {
    GpuLight lights[];
};
layout(binding = 7, rgba16f) writeonly uniform image2D outRadiance;

vec2 centreOf(ivec2 pixel, uvec2 size) {
    return (vec2(pixel) + 0.5) / vec2(size) * 2 - 1;
}

/// Unshadowed point and spot lights, with the falloff of KHR_lights_punctual.
vec3 punctual(Surface s, vec3 position) {
    vec3 sum = vec3(0);
    for (uint i = 0; i < light.lightCount; ++i) {
        const GpuLight l = lights[i];
        const vec3 to = l.position - position;
        const float d2 = max(dot(to, to), 1e-8);
        const vec3 direction = to * inversesqrt(d2);
        float strength = 1 / d2;
        if (l.range > 0) {
            const float q = d2 / (l.range * l.range);
            strength *= clamp(1 - q * q, 0, 1);
        }
        if (l.kind == 2) {
            const float cone =
                clamp(dot(l.direction, -direction) * l.coneScale + l.coneOffset, 0, 1);
            strength *= cone * cone;
        }
        sum += reflected(s, direction) * l.color * strength;
    }
    return sum;
}

/// Shades the pixel, met at `ndc`. `term`: visibility of sun and sky, pattern, occlusion.
void combine(ivec2 pixel, vec2 ndc, float depth, vec4 term) {
    const vec3 ray = rayThrough(view, ndc);
    const vec3 direction = normalize(ray);
    const uvec4 material = texelFetch(surfaceMaterial, pixel, 0);
    const vec4 albedo = unpackUnorm4x8(material.x);  // a: occlusion
    const vec2 visible = term.xy;
    const Surface s = surfaceOf(material, veins(light.noiseOctaves == 0 ? 1 : term.z), -direction);

    // The sky is looked up once: past the surfaces, or mirrored in one.
    const bool hit = depth > 0;
    const vec3 seenAt = hit ? reflect(direction, s.normal) : direction;
    const vec3 seen = skyRadiance(sky, light.skyLevels, seenAt, hit ? s.perceptualRoughness : 0);
    if (!hit) {
        imageStore(outRadiance, pixel,
                   kBackdrop != 0
                       ? pastSurfaces(light.backdrop, light.exposure)
                       : pastSurfaces(seen, direction, light.toSun, light.sunIlluminance));
        return;
    }

    const float fromSky = albedo.a * fromSkyThatIs(visible.y) * (1 - term.w);
    vec3 radiance = reflected(s, light.toSun) * light.sunIlluminance * visible.x;
    radiance += reflectedSky(s, skyIrradiance(light.irradiance, s.normal), seen) * fromSky;
    if (kPunctualLights != 0) radiance += light.perLux * punctual(s, view.eye + ray * depth);
    if (kEmissive != 0) radiance += light.perLux * texelFetch(surfaceEmissive, pixel, 0).rgb;
    // Unlit surfaces show the colour they were given: alpha 0 keeps the tone curve off them.
    const bool unlit = kUnlit != 0 && (material.y >> 16 & LS_MATERIAL_UNLIT) != 0;
    if (unlit) radiance = albedo.rgb * albedo.rgb / light.exposure;
    imageStore(outRadiance, pixel, vec4(radiance, unlit ? 0 : 1));
}

#endif

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/tiles.glsl"
#include "../visibility/view_params.h"
#include "../scene/gpu_types.h"
#include "brdf.glsl"
#include "combine_params.h"
#include "sky.glsl"
#include "terms_effect.glsl"

// The cheap, detailed shading at full resolution, joined with the reconstructed terms: one thread a
// pixel of grid O.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kEmissive = 1;
layout(constant_id = 1) const uint kUnlit = 1;

layout(binding = 0, scalar) uniform View { ViewParams view; };
layout(binding = 1, scalar) uniform Light { LightParams light; };
layout(binding = 2) uniform sampler2D surfaceDepth;
layout(binding = 3) uniform usampler2D surfaceMaterial;
layout(binding = 4) uniform sampler2D surfaceEmissive;
layout(binding = 5) uniform sampler2D terms;  // visibility of sun and sky, pattern, occlusion
layout(binding = 6) uniform sampler2D sky;
layout(binding = 7, scalar) readonly buffer Lights { GpuLight lights[]; };
layout(binding = 8, rgba16f) writeonly uniform image2D outRadiance;
layout(binding = 9) uniform sampler2D points;  // NDC
layout(binding = 10) uniform usampler2D coarse;         // grid S
layout(binding = 11) uniform usampler2D surfaceNormal;  // in view space
layout(binding = 12) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push { CombineParams params; };

layout(constant_id = 2) const uint kPunctualLights = 1;
layout(constant_id = 3) const uint kPoints = 0;  // 1: at `points`, not at the centres of pixels
layout(constant_id = 4) const uint kBackdrop = 0;  // 1: one colour in the place of the sky
layout(constant_id = 5) const uint kOnS = 0;  // 1: terms of grid S, reconstructed; not `terms`
layout(constant_id = 6) const uint kDomain = LS_DOMAIN_TENT;
layout(constant_id = 7) const uint kRange = 1;
const uint kRepair = 0;

#include "../upsample/reconstruct.glsl"

vec4 termsOf(ivec2 pixel, float depth) {
    if (kOnS == 0) return texelFetch(terms, pixel, 0);
    Likeness ignored;
    return reconstruct(pixel, depth, texelFetch(surfaceNormal, pixel, 0).x, params.from, ignored);
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

void main() {
    const ivec2 pixel = pixelOfThread(tiles);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;

    const vec2 ndc = kPoints != 0 ? texelFetch(points, pixel, 0).xy
                                  : (vec2(pixel) + 0.5) / vec2(params.size) * 2 - 1;
    const vec3 ray = rayThrough(view, ndc);
    const vec3 direction = normalize(ray);
    const float depth = texelFetch(surfaceDepth, pixel, 0).x;
    const uvec4 material = texelFetch(surfaceMaterial, pixel, 0);
    const vec4 albedo = unpackUnorm4x8(material.x);  // a: occlusion
    const vec4 term = termsOf(pixel, depth);
    const vec2 visible = term.xy;
    const Surface s =
        surfaceOf(material, veins(light.noiseOctaves == 0 ? 1 : term.z), -direction);

    // The sky is looked up once: past the surfaces, or mirrored in one.
    const bool hit = depth > 0;
    const vec3 seenAt = hit ? reflect(direction, s.normal) : direction;
    const vec3 seen =
        skyRadiance(sky, light.skyLevels, seenAt, hit ? s.perceptualRoughness : 0);
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

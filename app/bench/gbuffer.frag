// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_GOOGLE_include_directive : require
#include "gbuffer_params.h"
#include <lodestar/shared/octahedral.h>
#define LS_MATERIAL_BINDING 6
#define LS_TEXTURE_BINDING 7
#include <lodestar/scene/material.glsl>

// What visibility/rebuild.comp writes, by the raster pipeline: interpolated by hardware, texture
// gradients from its quad differences.
layout(constant_id = 1) const uint kMasked = 0;
layout(constant_id = 2) const uint kBaseColorArrays = 255;
layout(constant_id = 3) const uint kNormalArrays = 255;
layout(constant_id = 4) const uint kMetallicRoughnessArrays = 255;
layout(constant_id = 5) const uint kOcclusionArrays = 255;
layout(constant_id = 6) const uint kEmissiveArrays = 255;
layout(constant_id = 7) const uint kOcclusionShared = 0;
layout(constant_id = 8) const uint kEmissive = 1;

layout(push_constant, scalar) uniform Push { GBufferParams params; };

layout(location = 0) in vec2 uv0;
layout(location = 1) in vec2 uv1;
layout(location = 2) in vec4 color;
layout(location = 3) in vec3 normal;
layout(location = 4) in vec3 tangent;
layout(location = 5) flat in float handedness;
layout(location = 6) flat in uint materialIndex;

layout(location = 0) out float outDepth;
layout(location = 1) out uint outNormal;
layout(location = 2) out uvec4 outMaterial;
layout(location = 3) out vec4 outEmissive;

vec3 unit(vec3 v) { return v * inversesqrt(max(dot(v, v), 1e-36)); }

void main() {
    TexturePlace place;
    place.material = materialIndex;
    place.set0 = TexturePoint(uv0, dFdx(uv0), dFdy(uv0));
    if (kUvTransforms != 0) place.set1 = TexturePoint(uv1, dFdx(uv1), dFdy(uv1));
    const GpuMaterial material = loadMaterial(materialIndex);

    vec4 albedo = material.baseColor * color;
    if (kBaseColorArrays != 0)
        albedo *= sampleTexture(material.baseColorTexture, 0, place, kBaseColorArrays);
    if (kMasked != 0 && albedo.a < material.alphaCutoff) discard;

    const vec3 n = unit(normal);
    const float side = gl_FrontFacing ? 1 : -1;
    vec3 shadingNormal = n;
    if (kNormalArrays != 0 && material.normalTexture != LS_NO_TEXTURE) {
        const vec3 tu = unit(tangent - n * dot(n, tangent));
        const vec3 tv = handedness * cross(n, tu);
        const vec3 m = sampleTexture(material.normalTexture, 1, place, kNormalArrays).xyz * 2 - 1;
        const vec2 bend = m.xy * material.normalScale;
        shadingNormal = unit(tu * bend.x + tv * bend.y + n * max(m.z, 1e-3));
    }

    float occlusion = 1, roughness = material.roughness, metallic = material.metallic;
    if (kMetallicRoughnessArrays != 0) {
        const vec4 orm =
            sampleTexture(material.metallicRoughnessTexture, 2, place, kMetallicRoughnessArrays);
        roughness *= orm.g;
        metallic *= orm.b;
        if (kOcclusionShared != 0 && material.occlusionTexture != LS_NO_TEXTURE)
            occlusion = mix(1.0, orm.r, material.occlusionStrength);
    }
    if (kOcclusionArrays != 0)
        occlusion = mix(1.0, sampleTexture(material.occlusionTexture, 3, place, kOcclusionArrays).r,
                        material.occlusionStrength);

    outDepth = 1 / gl_FragCoord.w;
    outNormal = packNormal(side * vec3(dot(params.viewRow0.xyz, n), dot(params.viewRow1.xyz, n),
                                       dot(params.viewRow2.xyz, n)));
    outMaterial = uvec4(packUnorm4x8(vec4(sqrt(clamp(albedo.rgb, 0, 1)), occlusion)),
                        packUnorm4x8(vec4(roughness, metallic, 0, 0)) | material.flags << 16,
                        packNormal(side * shadingNormal), packNormal(side * n));
    if (kEmissive != 0) {
        vec3 emissive = material.emissive;
        if (kEmissiveArrays != 0)
            emissive *= sampleTexture(material.emissiveTexture, 4, place, kEmissiveArrays).rgb;
        outEmissive = vec4(emissive, 0);
    }
}

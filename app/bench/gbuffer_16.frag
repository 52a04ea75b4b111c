// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_GOOGLE_include_directive : require
#include "gbuffer_params.h"
#include <lodestar/shared/octahedral.h>
#define LS_MATERIAL_BINDING 6
#define LS_TEXTURE_BINDING 7
#include <lodestar/scene/material.glsl>

// The thesis's reference G-buffer, 16 bytes a pixel: linear depth, albedo, normal, object.
layout(constant_id = 1) const uint kMasked = 0;
layout(constant_id = 2) const uint kBaseColorArrays = 255;
layout(constant_id = 3) const uint kNormalArrays = 255;

layout(push_constant, scalar) uniform Push { GBufferParams params; };

layout(location = 0) in vec2 uv0;
layout(location = 1) in vec2 uv1;
layout(location = 2) in vec4 color;
layout(location = 3) in vec3 normal;
layout(location = 4) in vec3 tangent;
layout(location = 5) flat in float handedness;
layout(location = 6) flat in uint materialIndex;
layout(location = 7) flat in uint triangleId;

layout(location = 0) out float outDepth;
layout(location = 1) out vec4 outAlbedo;
layout(location = 2) out uint outNormal;
layout(location = 3) out uint outId;

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
    vec3 shadingNormal = n;
    if (kNormalArrays != 0 && material.normalTexture != LS_NO_TEXTURE) {
        const vec3 tu = unit(tangent - n * dot(n, tangent));
        const vec3 tv = handedness * cross(n, tu);
        const vec3 m = sampleTexture(material.normalTexture, 1, place, kNormalArrays).xyz * 2 - 1;
        const vec2 bend = m.xy * material.normalScale;
        shadingNormal = unit(tu * bend.x + tv * bend.y + n * max(m.z, 1e-3));
    }
    outDepth = 1 / gl_FragCoord.w;
    outAlbedo = vec4(sqrt(clamp(albedo.rgb, 0, 1)), 1);
    outNormal = packNormal((gl_FrontFacing ? 1 : -1) * shadingNormal);
    outId = triangleId;
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "triangle.glsl"
#include "rebuild_params.h"
#include "../shared/tiles.glsl"
#include "view_params.h"
#define LS_MATERIAL_BINDING 12
#define LS_TEXTURE_BINDING 13
#include "../scene/material.glsl"

// From triangle ids to surface attributes, one thread a pixel of grid O.
layout(local_size_x = 8, local_size_y = 8) in;

// Which texture arrays each use can mean, as bits; 0 = no material of the scene has such a texture.
layout(constant_id = 1) const uint kBaseColorArrays = 255;
layout(constant_id = 2) const uint kNormalArrays = 255;
layout(constant_id = 3) const uint kMetallicRoughnessArrays = 255;
layout(constant_id = 4) const uint kOcclusionArrays = 255;
layout(constant_id = 5) const uint kEmissiveArrays = 255;
layout(constant_id = 6) const uint kOcclusionShared = 0;  // r of the metallic-roughness texture
layout(constant_id = 7) const uint kEmissive = 1;
layout(constant_id = 8) const uint kPoints = 0;  // 1: at `points`, not at the centres of pixels
layout(constant_id = 9) const uint kGuidesAlone = 0;  // 1: depth and normal, nothing else

layout(binding = 6, scalar) uniform View { ViewParams view; };
layout(binding = 7) uniform usampler2D ids;
layout(binding = 8, r32f) writeonly uniform image2D outDepth;
layout(binding = 9, r32ui) writeonly uniform uimage2D outNormal;
layout(binding = 10, rgba32ui) writeonly uniform uimage2D outMaterial;
layout(binding = 11, rgba16f) writeonly uniform image2D outEmissive;
layout(binding = 14) uniform samplerBuffer secondUvs;
layout(binding = 15) uniform sampler2D points;
layout(binding = 16) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push { RebuildParams params; };

TexturePoint interpolate(vec2 a, vec2 b, vec2 c, vec3 at, vec3 dx, vec3 dy) {
    return TexturePoint(a * at.x + b * at.y + c * at.z, a * dx.x + b * dx.y + c * dx.z,
                        a * dy.x + b * dy.y + c * dy.z);
}

void writeGuides(ivec2 pixel, Triangle t, Barycentrics b) {
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const float side = dot(faceNormal(t), view.eye - position) < 0 ? -1 : 1;
    imageStore(outDepth, pixel, vec4(b.depth));
    imageStore(outNormal, pixel,
               uvec4(packNormal(side * (mat3(view.viewFromWorld) * vertexNormal(t, b.at)))));
}

void rebuild(ivec2 pixel, uint id) {
    const Triangle t = loadTriangle(id);
    const vec2 toNdc = params.pixelNdc;
    const vec2 ndc = kPoints != 0 ? texelFetch(points, pixel, 0).xy
                                  : (vec2(pixel) + 0.5) * toNdc - 1;
    const Barycentrics b =
        barycentricsAt(view.clipFromWorld * vec4(t.p0, 1), view.clipFromWorld * vec4(t.p1, 1),
                       view.clipFromWorld * vec4(t.p2, 1), ndc);
    if (kGuidesAlone != 0) {
        writeGuides(pixel, t, b);
        return;
    }
    const vec2 toMip = toNdc * params.textureScale;
    const vec3 dx = b.dx * toMip.x, dy = b.dy * toMip.y;  // per pixel, biased

    const GpuVertexAttributes a0 = loadAttributes(t.vertices.x), a1 = loadAttributes(t.vertices.y),
                              a2 = loadAttributes(t.vertices.z);
    TexturePlace place;
    place.material = t.material;
    place.set0 = interpolate(a0.uv, a1.uv, a2.uv, b.at, dx, dy);
    if (kUvTransforms != 0)
        place.set1 = interpolate(texelFetch(secondUvs, int(t.vertices.x)).xy,
                                 texelFetch(secondUvs, int(t.vertices.y)).xy,
                                 texelFetch(secondUvs, int(t.vertices.z)).xy, b.at, dx, dy);
    const GpuMaterial material = loadMaterial(t.material);

    // The side that is seen: of a double-sided surface the normals turn towards the eye.
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const float side = dot(faceNormal(t), view.eye - position) < 0 ? -1 : 1;
    const vec3 normal = vertexNormal(t, b.at);
    vec3 shadingNormal = normal;
    if (kNormalArrays != 0 && material.normalTexture != LS_NO_TEXTURE) {
        const vec4 tangent0 = unpackTangent(a0.tangent);
        const vec3 tangent = transformDirection(
            t.instance, tangent0.xyz * b.at.x + unpackTangent(a1.tangent).xyz * b.at.y +
                            unpackTangent(a2.tangent).xyz * b.at.z);
        const float handedness =
            (t.instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -tangent0.w : tangent0.w;
        const vec3 along = tangent - normal * dot(normal, tangent);
        const vec3 tu = along * inversesqrt(max(dot(along, along), 1e-36));
        const vec3 tv = handedness * cross(normal, tu);
        const vec3 m = sampleTexture(material.normalTexture, 1, place, kNormalArrays).xyz * 2 - 1;
        const vec2 bend = m.xy * material.normalScale;
        shadingNormal = normalize(tu * bend.x + tv * bend.y + normal * max(m.z, 1e-3));
    }

    const vec4 color =
        unpackUnorm4x8(a0.color) * b.at.x + unpackUnorm4x8(a1.color) * b.at.y +
        unpackUnorm4x8(a2.color) * b.at.z;
    vec3 albedo = material.baseColor.rgb * color.rgb;
    if (kBaseColorArrays != 0) albedo *= sampleTexture(material.baseColorTexture, 0, place, kBaseColorArrays).rgb;

    float occlusion = 1, roughness = material.roughness, metallic = material.metallic;
    if (kMetallicRoughnessArrays != 0) {
        const vec4 orm = sampleTexture(material.metallicRoughnessTexture, 2, place, kMetallicRoughnessArrays);
        roughness *= orm.g;
        metallic *= orm.b;
        if (kOcclusionShared != 0 && material.occlusionTexture != LS_NO_TEXTURE)
            occlusion = mix(1.0, orm.r, material.occlusionStrength);
    }
    if (kOcclusionArrays != 0)
        occlusion = mix(1.0, sampleTexture(material.occlusionTexture, 3, place, kOcclusionArrays).r,
                        material.occlusionStrength);

    imageStore(outDepth, pixel, vec4(b.depth));
    imageStore(outNormal, pixel, uvec4(packNormal(side * (mat3(view.viewFromWorld) * normal))));
    // Albedo is stored by its square root: 8 bits then step evenly to the eye.
    imageStore(outMaterial, pixel,
               uvec4(packUnorm4x8(vec4(sqrt(clamp(albedo, 0, 1)), occlusion)),
                     packUnorm4x8(vec4(roughness, metallic, 0, 0)) | material.flags << 16,
                     packNormal(side * shadingNormal), packNormal(side * normal)));
    if (kEmissive != 0) {
        vec3 emissive = material.emissive;
        if (kEmissiveArrays != 0) emissive *= sampleTexture(material.emissiveTexture, 4, place, kEmissiveArrays).rgb;
        imageStore(outEmissive, pixel, vec4(emissive, 0));
    }
}

void main() {
    const ivec2 pixel = pixelOfThread(tiles);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const uint id = texelFetch(ids, pixel, 0).x;
    if (id == 0) {
        imageStore(outDepth, pixel, vec4(0));
        return;
    }
    rebuild(pixel, id);
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "triangle.glsl"
#include "view_params.h"
#define LS_TEXTURE_BINDING 13
#include "../scene/material.glsl"

// From triangle ids to surface attributes, one thread a pixel of grid O.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 2) const uint kNormalMaps = 1;
layout(constant_id = 3) const uint kMetallicRoughnessMaps = 1;
layout(constant_id = 4) const uint kOcclusionMaps = 1;         // read apart from metallic-roughness
layout(constant_id = 5) const uint kOcclusionShared = 0;       // r of the metallic-roughness texture
layout(constant_id = 6) const uint kEmissive = 1;
layout(constant_id = 7) const uint kEmissiveMaps = 1;

layout(binding = 6, scalar) uniform View { ViewParams view; };
layout(binding = 7) uniform usampler2D ids;
layout(binding = 8, r32f) writeonly uniform image2D outDepth;
layout(binding = 9, r32ui) writeonly uniform uimage2D outNormal;
layout(binding = 10, rgba32ui) writeonly uniform uimage2D outMaterial;
layout(binding = 11, rgba16f) writeonly uniform image2D outEmissive;
layout(binding = 12, scalar) readonly buffer Materials { GpuMaterial materials[]; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    const ivec2 size = textureSize(ids, 0);
    if (any(greaterThanEqual(pixel, size))) return;
    const uint id = texelFetch(ids, pixel, 0).x;
    if (id == 0) {
        imageStore(outDepth, pixel, vec4(0));
        return;
    }

    const Triangle t = loadTriangle(id);
    const vec2 toNdc = 2 / vec2(size);
    const Barycentrics b =
        barycentricsAt(view.clipFromWorld * vec4(t.p0, 1), view.clipFromWorld * vec4(t.p1, 1),
                       view.clipFromWorld * vec4(t.p2, 1), (vec2(pixel) + 0.5) * toNdc - 1);
    const vec3 dx = b.dx * toNdc.x, dy = b.dy * toNdc.y;  // per pixel

    const vec2 uvA = sceneVertices[t.vertices.x].uv0, uvB = sceneVertices[t.vertices.y].uv0,
               uvC = sceneVertices[t.vertices.z].uv0;
    const TexturePoint p0 = TexturePoint(uvA * b.at.x + uvB * b.at.y + uvC * b.at.z,
                                         uvA * dx.x + uvB * dx.y + uvC * dx.z,
                                         uvA * dy.x + uvB * dy.y + uvC * dy.z);
    TexturePoint p1 = p0;
    if (kUvTransforms != 0) {
        const vec2 a = sceneVertices[t.vertices.x].uv1, c = sceneVertices[t.vertices.y].uv1,
                   d = sceneVertices[t.vertices.z].uv1;
        p1 = TexturePoint(a * b.at.x + c * b.at.y + d * b.at.z, a * dx.x + c * dx.y + d * dx.z,
                          a * dy.x + c * dy.y + d * dy.z);
    }
    const GpuMaterial material = materials[t.material];

    // The side that is seen: of a double-sided surface the normals turn towards the eye.
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const float side = dot(faceNormal(t), view.eye - position) < 0 ? -1 : 1;
    const vec3 normal = vertexNormal(t, b.at);
    vec3 shadingNormal = normal;
    if (kNormalMaps != 0 && material.normalTexture.array != LS_NO_TEXTURE) {
        const vec4 tangentA = unpackTangent(sceneVertices[t.vertices.x].tangent);
        const vec3 tangentObject =
            tangentA.xyz * b.at.x +
            unpackTangent(sceneVertices[t.vertices.y].tangent).xyz * b.at.y +
            unpackTangent(sceneVertices[t.vertices.z].tangent).xyz * b.at.z;
        const vec3 tangent = transformDirection(t.instance, tangentObject);
        const float handedness =
            (t.instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -tangentA.w : tangentA.w;
        const vec3 along = tangent - normal * dot(normal, tangent);
        const vec3 tu = along * inversesqrt(max(dot(along, along), 1e-36));
        const vec3 tv = handedness * cross(normal, tu);
        const vec3 m = sampleTexture(material.normalTexture, p0, p1).xyz * 2 - 1;
        const vec2 bend = m.xy * material.normalScale;
        shadingNormal = normalize(tu * bend.x + tv * bend.y + normal * max(m.z, 1e-3));
    }

    const vec4 color =
        unpackUnorm4x8(sceneVertices[t.vertices.x].color) * b.at.x +
        unpackUnorm4x8(sceneVertices[t.vertices.y].color) * b.at.y +
        unpackUnorm4x8(sceneVertices[t.vertices.z].color) * b.at.z;
    vec3 albedo = material.baseColor.rgb * color.rgb;
    if (kTextureArrays != 0) albedo *= sampleTexture(material.baseColorTexture, p0, p1).rgb;

    float occlusion = 1, roughness = material.roughness, metallic = material.metallic;
    if (kMetallicRoughnessMaps != 0) {
        const vec4 orm = sampleTexture(material.metallicRoughnessTexture, p0, p1);
        roughness *= orm.g;
        metallic *= orm.b;
        if (kOcclusionShared != 0 && material.occlusionTexture.array != LS_NO_TEXTURE)
            occlusion = mix(1.0, orm.r, material.occlusionStrength);
    }
    if (kOcclusionMaps != 0)
        occlusion = mix(1.0, sampleTexture(material.occlusionTexture, p0, p1).r,
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
        if (kEmissiveMaps != 0) emissive *= sampleTexture(material.emissiveTexture, p0, p1).rgb;
        imageStore(outEmissive, pixel, vec4(emissive, 0));
    }
}

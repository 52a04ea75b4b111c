// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_GOOGLE_include_directive : require
#include "deferred_params.h"
#include <lodestar/visibility/triangle.glsl>
layout(constant_id = 3) const uint kSide = 4;
#define LS_HEADS_BINDING 6
#define LS_LISTS_BINDING 7
#include <lodestar/visibility/record.glsl>
#define LS_MATERIAL_BINDING 12
#define LS_TEXTURE_BINDING 13
#include <lodestar/scene/material.glsl>
#include "phong.glsl"

// The same shading straight from the compact record at its capture rate, one thread a pixel of O:
// what the reference's G-buffer holds is found here, and written only when asked for.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 1) const uint kBaseColorArrays = 255;
layout(constant_id = 2) const uint kNormalArrays = 255;
layout(constant_id = 4) const uint kAttributes = 0;  // 1: write them, rather than the colour

layout(binding = 8, rgba8) writeonly uniform image2D outColor;
layout(binding = 9, r32f) writeonly uniform image2D outDepth;
layout(binding = 10, rgba8) writeonly uniform image2D outAlbedo;
layout(binding = 11, r32ui) writeonly uniform uimage2D outNormal;
layout(binding = 14) uniform samplerBuffer secondUvs;
layout(binding = 15, r32ui) writeonly uniform uimage2D outIds;
layout(push_constant, scalar) uniform Push { PhongParams params; };

TexturePoint interpolate(vec2 a, vec2 b, vec2 c, vec3 at, vec3 dx, vec3 dy) {
    return TexturePoint(a * at.x + b * at.y + c * at.z, a * dx.x + b * dx.y + c * dx.z,
                        a * dy.x + b * dy.y + c * dy.z);
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    const ivec2 size = ivec2(params.base * kSide);
    if (any(greaterThanEqual(pixel, size))) return;
    const ivec2 owner = pixel / int(kSide), inside = pixel % int(kSide);
    const uint sample_ = uint(inside.y) * kSide + uint(inside.x);
    const Head head = loadHead(uint(owner.y) * params.base.x + uint(owner.x));
    uint id = head.id;
    for (uint i = head.list; head.listed; i += kNodeWords) {
        const Node node = loadNode(i);
        if (shows(node, sample_)) id = node.id & ~LS_LAST_NODE;
        if ((node.id & LS_LAST_NODE) != 0) break;
    }
    if (id == 0) {
        if (kAttributes != 0) {
            imageStore(outDepth, pixel, vec4(0));
            imageStore(outAlbedo, pixel, vec4(0));
            imageStore(outNormal, pixel, uvec4(0));
            imageStore(outIds, pixel, uvec4(0));
        } else {
            imageStore(outColor, pixel, kBackground);
        }
        return;
    }

    const Triangle t = loadTriangle(id);
    const vec2 toNdc = 2 / vec2(size);
    const Barycentrics b =
        barycentricsAt(params.clipFromWorld * vec4(t.p0, 1), params.clipFromWorld * vec4(t.p1, 1),
                       params.clipFromWorld * vec4(t.p2, 1), (vec2(pixel) + 0.5) * toNdc - 1);
    const vec3 dx = b.dx * toNdc.x, dy = b.dy * toNdc.y;
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
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const float side = dot(faceNormal(t), params.eye - position) < 0 ? -1 : 1;
    const vec3 n = vertexNormal(t, b.at);
    vec3 normal = n;
    if (kNormalArrays != 0 && material.normalTexture != LS_NO_TEXTURE) {
        const vec4 tangent0 = unpackTangent(a0.tangent);
        const vec3 tangent = transformDirection(
            t.instance, tangent0.xyz * b.at.x + unpackTangent(a1.tangent).xyz * b.at.y +
                            unpackTangent(a2.tangent).xyz * b.at.z);
        const float handedness =
            (t.instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -tangent0.w : tangent0.w;
        const vec3 along = tangent - n * dot(n, tangent);
        const vec3 tu = along * inversesqrt(max(dot(along, along), 1e-36));
        const vec3 tv = handedness * cross(n, tu);
        const vec3 m = sampleTexture(material.normalTexture, 1, place, kNormalArrays).xyz * 2 - 1;
        const vec2 bend = m.xy * material.normalScale;
        normal = normalize(tu * bend.x + tv * bend.y + n * max(m.z, 1e-3));
    }
    const vec4 color = unpackUnorm4x8(a0.color) * b.at.x + unpackUnorm4x8(a1.color) * b.at.y +
                       unpackUnorm4x8(a2.color) * b.at.z;
    vec3 albedo = material.baseColor.rgb * color.rgb;
    if (kBaseColorArrays != 0)
        albedo *= sampleTexture(material.baseColorTexture, 0, place, kBaseColorArrays).rgb;
    if (kAttributes != 0) {
        imageStore(outDepth, pixel, vec4(b.depth));
        imageStore(outAlbedo, pixel, vec4(sqrt(clamp(albedo, 0, 1)), 1));
        imageStore(outNormal, pixel, uvec4(packNormal(side * normal)));
        imageStore(outIds, pixel, uvec4(id));
    } else {
        imageStore(outColor, pixel,
                   phong(albedo, side * normal, normalize(params.eye - position)));
    }
}

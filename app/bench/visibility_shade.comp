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

// The same shading straight from the compact record at its capture rate: what the reference's
// G-buffer holds is found here, and written only when asked for. A workgroup takes 64 pixels of grid
// B and shades the triangles that they list, each fetched once for all its samples of a pixel, those
// with as many samples side by side: threads that run in step then wait for nobody.
const uint kPixels = 64;
layout(local_size_x = kPixels) in;

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

/// A triangle with all that its samples share.
struct Source {
    uint id;
    Triangle t;
    vec4 clip0, clip1, clip2;
    GpuVertexAttributes a0, a1, a2;
    GpuMaterial material;
    vec3 face;
};

Source loadSource(uint id) {
    Source s;
    s.id = id;
    s.t = loadTriangle(id);
    s.clip0 = params.clipFromWorld * vec4(s.t.p0, 1);
    s.clip1 = params.clipFromWorld * vec4(s.t.p1, 1);
    s.clip2 = params.clipFromWorld * vec4(s.t.p2, 1);
    s.a0 = loadAttributes(s.t.vertices.x);
    s.a1 = loadAttributes(s.t.vertices.y);
    s.a2 = loadAttributes(s.t.vertices.z);
    s.material = loadMaterial(s.t.material);
    s.face = faceNormal(s.t);
    return s;
}

void writeBackground(ivec2 pixel) {
    if (kAttributes != 0) {
        imageStore(outDepth, pixel, vec4(0));
        imageStore(outAlbedo, pixel, vec4(0));
        imageStore(outNormal, pixel, uvec4(0));
        imageStore(outIds, pixel, uvec4(0));
    } else {
        imageStore(outColor, pixel, kBackground);
    }
}

void shade(Source s, ivec2 pixel) {
    const vec2 toNdc = 2 / vec2(params.base * kSide);
    const Barycentrics b =
        barycentricsAt(s.clip0, s.clip1, s.clip2, (vec2(pixel) + 0.5) * toNdc - 1);
    const vec3 dx = b.dx * toNdc.x, dy = b.dy * toNdc.y;
    TexturePlace place;
    place.material = s.t.material;
    place.set0 = interpolate(s.a0.uv, s.a1.uv, s.a2.uv, b.at, dx, dy);
    if (kUvTransforms != 0)
        place.set1 = interpolate(texelFetch(secondUvs, int(s.t.vertices.x)).xy,
                                 texelFetch(secondUvs, int(s.t.vertices.y)).xy,
                                 texelFetch(secondUvs, int(s.t.vertices.z)).xy, b.at, dx, dy);
    const vec3 position = s.t.p0 * b.at.x + s.t.p1 * b.at.y + s.t.p2 * b.at.z;
    const float side = dot(s.face, params.eye - position) < 0 ? -1 : 1;
    const vec3 n = vertexNormal(s.t, b.at);
    vec3 normal = n;
    if (kNormalArrays != 0 && s.material.normalTexture != LS_NO_TEXTURE) {
        const vec4 tangent0 = unpackTangent(s.a0.tangent);
        const vec3 tangent = transformDirection(
            s.t.instance, tangent0.xyz * b.at.x + unpackTangent(s.a1.tangent).xyz * b.at.y +
                              unpackTangent(s.a2.tangent).xyz * b.at.z);
        const float handedness =
            (s.t.instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -tangent0.w : tangent0.w;
        const vec3 along = tangent - n * dot(n, tangent);
        const vec3 tu = along * inversesqrt(max(dot(along, along), 1e-36));
        const vec3 tv = handedness * cross(n, tu);
        const vec3 m =
            sampleTexture(s.material.normalTexture, 1, place, kNormalArrays).xyz * 2 - 1;
        const vec2 bend = m.xy * s.material.normalScale;
        normal = normalize(tu * bend.x + tv * bend.y + n * max(m.z, 1e-3));
    }
    const vec4 color = unpackUnorm4x8(s.a0.color) * b.at.x + unpackUnorm4x8(s.a1.color) * b.at.y +
                       unpackUnorm4x8(s.a2.color) * b.at.z;
    vec3 albedo = s.material.baseColor.rgb * color.rgb;
    if (kBaseColorArrays != 0)
        albedo *= sampleTexture(s.material.baseColorTexture, 0, place, kBaseColorArrays).rgb;
    if (kAttributes != 0) {
        imageStore(outDepth, pixel, vec4(b.depth));
        imageStore(outAlbedo, pixel, vec4(sqrt(clamp(albedo, 0, 1)), 1));
        imageStore(outNormal, pixel, uvec4(packNormal(side * normal)));
        imageStore(outIds, pixel, uvec4(s.id));
    } else {
        imageStore(outColor, pixel,
                   phong(albedo, side * normal, normalize(params.eye - position)));
    }
}

/// Takes the lowest sample out of a mask that is not empty: its place in its pixel.
uvec2 take(inout uvec2 mask) {
    const uint i = mask.x != 0 ? findLSB(mask.x) : 32 + findLSB(mask.y);
    if (i < 32)
        mask.x &= mask.x - 1;
    else
        mask.y &= mask.y - 1;
    return uvec2(i % kSide, i / kSide);
}

shared Head heads[kPixels];
shared List lists[kPixels];
shared uint ends[kPixels];             // of the items with 1, 2, … samples
shared uint items[kPixels * kSamples];  // pixel << 6 | number in its list

void sortItems(uint own, bool inside) {
    ends[own] = 0;
    barrier();
    const List list = lists[own];
    for (uint k = 0; k < (inside ? list.count : 0); ++k)
        atomicAdd(ends[samplesOf(listedMask(list, k)) - 1], 1);
    barrier();
    uint before = 0;
    for (uint i = 0; i < own; ++i) before += ends[i];
    barrier();
    ends[own] = before;
    barrier();
    for (uint k = 0; k < (inside ? list.count : 0); ++k)
        items[atomicAdd(ends[samplesOf(listedMask(list, k)) - 1], 1)] = own << 6 | k;
    barrier();
}

void main() {
    const uint own = gl_LocalInvocationID.x;
    const uint first = (gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x) * kPixels;
    const bool inside = first + own < params.base.x * params.base.y;
    heads[own] = loadHead(inside ? first + own : 0);
    lists[own] = loadList(heads[own]);
    sortItems(own, inside);
    for (uint i = own; i < ends[kPixels - 1]; i += kPixels) {
        const uint pixel = items[i] >> 6, k = items[i] & 63;
        const List list = lists[pixel];
        const uint id = heads[pixel].listed ? listedId(list, k) : heads[pixel].id;
        const uvec2 at = uvec2((first + pixel) % params.base.x, (first + pixel) / params.base.x);
        uvec2 mask = listedMask(list, k);
        // A loop without iterations, rather than a branch, for what shows nothing: some drivers run
        // both sides of a branch.
        while (id == 0 && (mask.x | mask.y) != 0)
            writeBackground(ivec2(at * kSide + take(mask)));
        const Source source = loadSource(id);
        while ((mask.x | mask.y) != 0) shade(source, ivec2(at * kSide + take(mask)));
    }
}

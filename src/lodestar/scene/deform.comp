// SPDX-License-Identifier: Apache-2.0
#version 460
#include "deform_params.h"
#include "gpu_types.h"
#include "../shared/octahedral.h"

// Morphs, then skins, one vertex a thread (glTF 2.0, 3.7.2 and 3.7.3).
layout(local_size_x = 64) in;

layout(binding = 0) uniform samplerBuffer rest;  // position, side; normal; tangent
layout(binding = 1) uniform usamplerBuffer influences;  // joint, weight
layout(binding = 2) uniform samplerBuffer deltas;
layout(binding = 3) uniform samplerBuffer joints;  // three rows each
layout(binding = 4) uniform usamplerBuffer weighted;  // first delta, weight
layout(binding = 5, scalar) writeonly buffer Vertices { GpuVertex vertices[]; };
layout(binding = 6, scalar) buffer Attributes { GpuVertexAttributes attributes[]; };
layout(push_constant, scalar) uniform Push { DeformParams params; };

vec3 unitOr(vec3 v, vec3 otherwise) {
    const float size = length(v);
    return size > 1e-30 && !isinf(size) ? v / size : otherwise;
}

void main() {
    const uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    const uint v = group * 64 + gl_LocalInvocationID.x;
    if (v >= params.vertexCount) return;

    const int at = int(3 * (params.firstRest + v));
    const vec4 first = texelFetch(rest, at);
    const vec3 restNormal = texelFetch(rest, at + 1).xyz, restTangent = texelFetch(rest, at + 2).xyz;
    vec3 position = first.xyz, normal = restNormal, tangent = restTangent;
    for (uint i = 0; i < params.activeCount; ++i) {
        const uvec2 target = texelFetch(weighted, int(params.firstActive + i)).xy;
        const float weight = uintBitsToFloat(target.y);
        int row = int(target.x + v * params.deltaRows);
        if ((params.deltas & LS_DELTA_POSITION) != 0)
            position += weight * texelFetch(deltas, row++).xyz;
        if ((params.deltas & LS_DELTA_NORMAL) != 0)
            normal += weight * texelFetch(deltas, row++).xyz;
        if ((params.deltas & LS_DELTA_TANGENT) != 0)
            tangent += weight * texelFetch(deltas, row++).xyz;
    }

    const float held = params.joints > 0 ? 0 : 1;
    vec4 row0 = vec4(held, 0, 0, 0), row1 = vec4(0, held, 0, 0), row2 = vec4(0, 0, held, 0);
    for (uint k = 0; k < params.joints; ++k) {
        const uvec2 by =
            texelFetch(influences, int(params.firstInfluence + v * params.joints + k)).xy;
        const float weight = uintBitsToFloat(by.y);
        const int joint = int(3 * (params.firstJoint + by.x));
        row0 += weight * texelFetch(joints, joint);
        row1 += weight * texelFetch(joints, joint + 1);
        row2 += weight * texelFetch(joints, joint + 2);
    }
    const vec4 p = vec4(position, 1);
    const vec3 moved = vec3(dot(row0, p), dot(row1, p), dot(row2, p));
    // Normals go by the cofactors, which exist for singular matrices too; the sign undoes what a
    // reflection does to them.
    const vec3 c0 = cross(row1.xyz, row2.xyz), c1 = cross(row2.xyz, row0.xyz),
               c2 = cross(row0.xyz, row1.xyz);
    const float side = dot(row0.xyz, c0) < 0 ? -1 : 1;
    normal = side * vec3(dot(c0, normal), dot(c1, normal), dot(c2, normal));
    tangent = vec3(dot(row0.xyz, tangent), dot(row1.xyz, tangent), dot(row2.xyz, tangent));

    const uint to = params.firstVertex + v;
    vertices[to] = GpuVertex(moved, packNormal(unitOr(normal, restNormal)));
    attributes[to].tangent = packTangent(vec4(unitOr(tangent, restTangent), first.w));
}

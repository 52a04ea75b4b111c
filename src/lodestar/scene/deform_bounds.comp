// SPDX-License-Identifier: Apache-2.0
#version 460
#include "deform_params.h"
#include "gpu_types.h"

// The bounding spheres of deformed meshlets, one a thread: about the middle of their box.
layout(local_size_x = 64) in;

layout(binding = 0) uniform usamplerBuffer vertices;
layout(binding = 1) uniform usamplerBuffer triangles;
layout(binding = 2, scalar) buffer Meshlets { GpuMeshlet meshlets[]; };
layout(push_constant, scalar) uniform Push { DeformBoundsParams params; };

vec3 positionOf(uint vertex) { return uintBitsToFloat(texelFetch(vertices, int(vertex)).xyz); }

void main() {
    const uint group = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    const uint index = group * 64 + gl_LocalInvocationID.x;
    if (index >= params.meshletCount) return;
    const uint meshlet = params.firstMeshlet + index;
    const uint first = meshlets[meshlet].triangles, count = meshlets[meshlet].counts & 255u;
    vec3 lower = vec3(1e30), upper = vec3(-1e30);
    for (uint i = 0; i < count; ++i) {
        const uvec4 t = texelFetch(triangles, int(first + i));
        const vec3 a = positionOf(t.x), b = positionOf(t.y), c = positionOf(t.z);
        lower = min(lower, min(a, min(b, c)));
        upper = max(upper, max(a, max(b, c)));
    }
    const vec3 centre = 0.5 * (lower + upper);
    float most = 0;
    for (uint i = 0; i < count; ++i) {
        const uvec4 t = texelFetch(triangles, int(first + i));
        most = max(most, max(distance(centre, positionOf(t.x)),
                             max(distance(centre, positionOf(t.y)),
                                 distance(centre, positionOf(t.z)))));
    }
    meshlets[meshlet].centre = centre;
    meshlets[meshlet].radius = most * (1 + 1e-5) + 1e-6 * length(centre);
}

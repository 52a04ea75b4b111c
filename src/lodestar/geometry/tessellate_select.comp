// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"
#include "tessellate_params.h"

// One thread a meshlet of a displaced instance: which of its triangles are to be refined, and how
// many? None of a meshlet that is out of view.
layout(local_size_x = LS_SPAN) in;

layout(binding = 6, scalar) uniform Params { TessellateParams params; };
layout(binding = 7) uniform usamplerBuffer displaced;
layout(binding = 8) uniform usamplerBuffer pairs;
layout(binding = 9, scalar) buffer Header { TessellateHeader header; };
layout(binding = 10, scalar) writeonly buffer Masks { uvec4 masks[]; };
layout(binding = 11, scalar) writeonly buffer Offsets { uint counts[]; };
// false: counts the triangles within each reach; true: marks those within the one that fits.
layout(constant_id = 0) const bool kMark = false;

#include "tessellate.glsl"

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index >= params.pairs) return;
    const uvec2 pair = texelFetch(pairs, int(index)).xy;
    const uvec4 relief = texelFetch(displaced, int(2 * pair.x));
    const GpuInstance instance = loadInstance(relief.w);
    const GpuMeshlet meshlet = loadMeshlet(pair.y);
    const float begins = uintBitsToFloat(relief.y) * (kMark ? reachThatFits(header.within) : params.reach);
    const vec3 eye = eyeIn(instance);
    const float radius = meshlet.radius + uintBitsToFloat(relief.x);
    bool near = index > 0 && distance(eye, meshlet.centre) - radius < begins;
    const vec3 centre = transformPoint(instance, meshlet.centre);
    for (int i = 0; i < 5; ++i)
        near = near && dot(params.planes[i], vec4(centre, 1)) >= -radius * instance.maxScale;

    uvec4 mask = uvec4(0);
    uint count = 0;
    uint within[LS_TESS_REACHES];
    for (uint k = 0; k < LS_TESS_REACHES; ++k) within[k] = 0;
    for (uint i = 0; i < (near ? meshletTriangles(meshlet) : 0); ++i) {
        const GpuTriangle t = loadStoredTriangle(meshlet.triangles + i);
        const vec3 a = loadVertex(t.a).position, b = loadVertex(t.b).position,
                   c = loadVertex(t.c).position;
        const float apart =
            min(edgeApart(a, b, eye), min(edgeApart(b, c, eye), edgeApart(c, a, eye)));
        if (kMark) {
            const bool halved = divisionsAt(apart, begins) > 0;
            mask[i / 32] |= uint(halved) << (i & 31);
            count += uint(halved);
            continue;
        }
        float limit = begins;
        for (uint k = 0; k < LS_TESS_REACHES; ++k) {
            within[k] += uint(apart < limit);
            limit *= sqrt(0.5);
        }
    }
    if (kMark) {
        masks[index] = mask;
        counts[index] = count;
        return;
    }
    for (uint k = 0; k < LS_TESS_REACHES; ++k)
        if (within[k] > 0) atomicAdd(header.within[k], within[k]);
}

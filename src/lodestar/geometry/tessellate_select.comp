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
layout(binding = 9, scalar) writeonly buffer Masks { uvec4 masks[]; };
layout(binding = 10, scalar) writeonly buffer Offsets { uint counts[]; };

#include "tessellate.glsl"

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index >= params.pairs) return;
    const uvec2 pair = texelFetch(pairs, int(index)).xy;
    const vec4 relief = uintBitsToFloat(texelFetch(displaced, int(2 * pair.x)));
    const GpuInstance instance = loadInstance(texelFetch(displaced, int(2 * pair.x + 1)).w);
    const GpuMeshlet meshlet = loadMeshlet(pair.y);
    const float begins = relief.w * params.reach;
    const vec3 eye = eyeIn(instance);
    const float radius = meshlet.radius + relief.x;
    bool near = index > 0 && distance(eye, meshlet.centre) - radius < begins;
    const vec3 centre = transformPoint(instance, meshlet.centre);
    for (int i = 0; i < 5; ++i)
        near = near && dot(params.planes[i], vec4(centre, 1)) >= -radius * instance.maxScale;

    uvec4 mask = uvec4(0);
    uint count = 0;
    for (uint i = 0; i < (near ? meshlet.triangleCount : 0); ++i) {
        const GpuTriangle t = loadStoredTriangle(meshlet.triangles + i);
        const vec3 a = loadVertex(t.a).position, b = loadVertex(t.b).position,
                   c = loadVertex(t.c).position;
        const uint most = max(divisionsOf(a, b, eye, begins),
                              max(divisionsOf(b, c, eye, begins), divisionsOf(c, a, eye, begins)));
        if (most > 0) {
            mask[i / 32] |= 1u << (i & 31);
            ++count;
        }
    }
    masks[index] = mask;
    counts[index] = count;
}

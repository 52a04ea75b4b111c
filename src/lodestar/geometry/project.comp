// SPDX-License-Identifier: Apache-2.0
#version 460
#include "project.glsl"
#include "cull_params.h"

// Four threads a listed cluster: its vertices on the sample grid, each once for all triangles that have
// it.
layout(local_size_x = LS_SPAN) in;

layout(binding = 6) uniform usamplerBuffer meshletVertices;
layout(binding = 7, scalar) buffer Counts { CullCounts counts; };
layout(binding = 8, scalar) writeonly buffer Vertices { uvec2 vertices[]; };
layout(binding = 9, scalar) writeonly buffer Depths { float depths[]; };
layout(push_constant, scalar) uniform Push { ProjectParams push; };

void main() {
    const uint thread =
        linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_SPAN, gl_LocalInvocationID.x);
    const uint before = push.phase == 1 ? counts.lists[LS_LIST_CLUSTERS].count : 0;
    const uint own = counts.lists[push.phase == 1 ? LS_LIST_CLUSTERS_2 : LS_LIST_CLUSTERS].count;
    if (thread == 0) {  // those that there is no room for go a slower way
        const uint room = push.capacity - min(before, push.capacity);
        const uint groups = (own - min(own, room) + LS_WORD_CLUSTERS - 1) / LS_WORD_CLUSTERS;
        const uint rows = max((groups + 32767) / 32768, 1);
        counts.beyond[push.phase].groups[0] = (groups + rows - 1) / rows;
        counts.beyond[push.phase].groups[1] = rows;
        counts.beyond[push.phase].groups[2] = 1;
    }
    const uint item = thread / LS_WORDS, slot = before + item;
    if (item >= own || slot >= push.capacity) return;
    const uvec4 cluster = texelFetch(sceneClusters, int(2 * (push.table + slot)));
    const uint bin = texelFetch(sceneClusters, int(2 * (push.table + slot) + 1)).z;
    const GpuInstance instance = loadInstance(cluster.x);
    const uvec4 meshlet = texelFetch(sceneMeshlets, int(3 * cluster.y + 2));
    const uint count = (meshlet.w >> LS_MESHLET_VERTICES_SHIFT) & 255u;
    const uint flags =
        ((instance.flags & LS_INSTANCE_REFLECTED) != 0 ? LS_PROJECTED_REFLECTED : 0) |
        ((bin & 1) != 0 ? LS_PROJECTED_DOUBLE_SIDED : 0);  // of scene::DrawBin
    for (uint i = thread % LS_WORDS; i < count; i += LS_WORDS) {
        const uint vertex = texelFetch(meshletVertices, int(meshlet.y + i)).x;
        const vec4 clip = clipOf(push.clipFromWorld, instance, vertex);
        const bool placed = inReach(clip);
        const ivec2 at = placed ? snappedTo(clip, push.size) : ivec2(0);
        const uint own = flags | outside(clip) | (placed ? 0 : LS_PROJECTED_CLIP);
        const uint place = slot * LS_MESHLET_VERTICES + i;
        vertices[place] = packProjected(at, own);
        depths[place] = clip.z / clip.w;
    }
}

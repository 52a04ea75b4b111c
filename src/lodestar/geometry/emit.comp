// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/gpu_types.h"
#include "cull_params.h"

// One thread 32 triangles of a visible cluster: writes the id of each triangle kept where the prefix
// sum says. The first threads write the draw commands.
layout(local_size_x = LS_SPAN) in;

struct DrawCommand {
    uint vertexCount, instanceCount, firstVertex, firstInstance;
};

layout(binding = 0) uniform usamplerBuffer clusters;
layout(binding = 1, scalar) buffer Counts { CullCounts counts; };
layout(binding = 2, scalar) readonly buffer Masks { uvec4 masks[]; };
layout(binding = 3, scalar) readonly buffer Offsets { uint offsets[]; };
layout(binding = 4, scalar) writeonly buffer Ids { uint ids[]; };
layout(binding = 5, scalar) writeonly buffer Draws { DrawCommand draws[8]; };  // four a phase
layout(push_constant, scalar) uniform Push { EmitParams push; };

struct Lists {
    uint clusters, firstCluster, triangles, firstTriangle;
};

Lists listsOf(uint phase) {
    if (phase == 0)
        return Lists(counts.lists[LS_LIST_CLUSTERS].count, push.phase.table, counts.lists[LS_LIST_TRIANGLES].count,
                     0);
    return Lists(counts.lists[LS_LIST_CLUSTERS_2].count, push.phase.table + counts.lists[LS_LIST_CLUSTERS].count,
                 counts.lists[LS_LIST_TRIANGLES_2].count, counts.lists[LS_LIST_TRIANGLES].count);
}

uint offsetOf(uint cluster) { return offsets[cluster] + offsets[push.totals + cluster / LS_BLOCK]; }

/// Triangles of the phase before a cluster's, or all of them.
uint trianglesBefore(Lists lists, uint cluster) {
    return cluster < lists.clusters ? min(offsetOf(cluster), lists.triangles) : lists.triangles;
}

/// First triangle of a bin. Clusters stand in the order of their bins.
uint binStart(Lists lists, uint bin) {
    uint low = 0, high = lists.clusters;
    while (low < high) {
        const uint middle = (low + high) / 2;
        if (texelFetch(clusters, int(2 * (lists.firstCluster + middle) + 1)).z < bin)
            low = middle + 1;
        else
            high = middle;
    }
    return trianglesBefore(lists, low);
}

void main() {
    const uint thread =
        linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_SPAN, gl_LocalInvocationID.x);
    const Lists lists = listsOf(push.phase.phase);
    if (thread < 4) {
        const uint begin = binStart(lists, thread), end = binStart(lists, thread + 1);
        draws[4 * push.phase.phase + thread] =
            DrawCommand(3 * (end - begin), 1, 3 * (lists.firstTriangle + begin), 0);
        if (push.phase.phase == 0) draws[4 + thread] = DrawCommand(0, 1, 0, 0);
    }
    if (thread == 0) {
        const uint before = lists.firstCluster - push.phase.table;
        counts.projected[push.phase.phase] =
            lists.firstTriangle +
            trianglesBefore(lists, push.capacity - min(before, push.capacity));
    }
    const uvec2 item = clusterAndWord(gl_WorkGroupID, gl_NumWorkGroups, gl_LocalInvocationID.x);
    if (item.x >= lists.clusters) return;
    const uvec4 mask = masks[item.x];
    const uint word = item.y;
    // After those kept in the words before.
    const ivec4 bits = bitCount(uvec4(word > 0, word > 1, word > 2, false) * mask);
    uint place = offsetOf(item.x) + uint(bits.x + bits.y + bits.z);
    const uint id = (lists.firstCluster + item.x) << LS_TRIANGLE_BITS | 32 * word;
    for (uint left = mask[word]; left != 0 && place < lists.triangles; left &= left - 1, ++place)
        ids[lists.firstTriangle + place] = id | uint(findLSB(left));
}

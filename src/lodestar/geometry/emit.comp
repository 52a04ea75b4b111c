// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One workgroup a visible cluster: writes the indices and ids of its triangles where the prefix sum
// says, and once the draw commands.
layout(local_size_x = 64) in;

struct DrawCommand {
    uint indexCount, instanceCount, firstIndex;
    int vertexOffset;
    uint firstInstance;
};

layout(binding = 7, scalar) readonly buffer Visible { uint visible[]; };
layout(binding = 8, scalar) readonly buffer Counts { VisibleCounts counts; };
layout(binding = 9, scalar) readonly buffer Masks { uvec4 masks[]; };
layout(binding = 10, scalar) readonly buffer Offsets { uint offsets[]; };
layout(binding = 11, scalar) writeonly buffer Indices { uint indices[]; };
layout(binding = 12, scalar) writeonly buffer Ids { uint ids[]; };
layout(binding = 13, scalar) writeonly buffer Draws { DrawCommand draws[4]; };

void main() {
    const uint which = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    const uint thread = gl_LocalInvocationID.x;
    if (which == 0 && thread < 4) {
        const uint begin = offsets[counts.binStarts[thread]];
        const uint end = offsets[counts.binStarts[thread + 1]];
        draws[thread] = DrawCommand(3 * (end - begin), 1, 3 * begin, 0, 0);
    }
    if (which >= counts.clusters) return;

    const uint index = visible[which];
    const uvec4 mask = masks[which];
    const ivec4 bits = bitCount(mask);
    const GpuCluster cluster = loadCluster(index);
    const bool reflected =
        (loadInstance(cluster.instance).flags & LS_INSTANCE_REFLECTED) != 0;
    for (uint t = thread; t < cluster.triangleCount; t += 64) {
        const uint word = t / 32, bit = 1u << (t & 31);
        if ((mask[word] & bit) == 0) continue;
        uint rank = uint(bitCount(mask[word] & (bit - 1)));
        for (uint before = 0; before < word; ++before) rank += uint(bits[before]);

        const uint at = offsets[which] + rank;
        const uint local = loadStoredTriangle(cluster.triangles + t).local;
        const uint b = local >> 8 & 255, c = local >> 16 & 255;
        const uint base = index << LS_VERTEX_BITS;
        indices[3 * at] = base | (local & 255);
        indices[3 * at + 1] = base | (reflected ? c : b);
        indices[3 * at + 2] = base | (reflected ? b : c);
        ids[at] = index << LS_TRIANGLE_BITS | t;
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One thread a triangle of the visible clusters: writes the indices and id of each triangle kept
// where the prefix sum says. The first threads write the draw commands.
layout(local_size_x = LS_CULL_GROUP) in;

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
    const uint slot = triangleSlot(gl_WorkGroupID, gl_NumWorkGroups, gl_LocalInvocationID.x);
    if (slot < 4) {
        const uint begin = offsets[counts.binStarts[slot]];
        const uint end = offsets[counts.binStarts[slot + 1]];
        draws[slot] = DrawCommand(3 * (end - begin), 1, 3 * begin, 0, 0);
    }
    const uint which = slot / LS_CLUSTER_SLOTS, t = slot % LS_CLUSTER_SLOTS;
    if (which >= counts.clusters) return;
    const uvec4 mask = masks[which];
    const uint word = t / 32, bit = 1u << (t & 31);
    if ((mask[word] & bit) == 0) return;

    // Its place among the kept ones: those in the words before, and those below it in its own.
    const uvec4 earlier = uvec4(word > 0, word > 1, word > 2, false) * mask;
    const ivec4 bits = bitCount(earlier);
    const uint rank = uint(bits.x + bits.y + bits.z + bitCount(mask[word] & (bit - 1)));
    const uint at = offsets[which] + rank;

    const uint index = visible[which];
    const GpuCluster cluster = loadCluster(index);
    const bool reflected = (loadInstance(cluster.instance).flags & LS_INSTANCE_REFLECTED) != 0;
    const uint local = loadStoredTriangle(cluster.triangles + t).local;
    const uint b = local >> 8 & 255, c = local >> 16 & 255;
    const uint base = index << LS_VERTEX_BITS;
    indices[3 * at] = base | (local & 255);
    indices[3 * at + 1] = base | (reflected ? c : b);
    indices[3 * at + 2] = base | (reflected ? b : c);
    ids[at] = index << LS_TRIANGLE_BITS | t;
}

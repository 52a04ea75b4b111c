// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/gpu_types.h"
#include "cull_params.h"

// One thread a triangle of the visible clusters: writes the id of each triangle kept where the prefix
// sum says. The first threads write the draw commands.
layout(local_size_x = LS_CULL_GROUP) in;

struct DrawCommand {
    uint vertexCount, instanceCount, firstVertex, firstInstance;
};

layout(binding = 0, scalar) readonly buffer Visible { uint visible[]; };
layout(binding = 1, scalar) readonly buffer Counts { VisibleCounts counts; };
layout(binding = 2, scalar) readonly buffer Masks { uvec4 masks[]; };
layout(binding = 3, scalar) readonly buffer Offsets { uint offsets[]; };
layout(binding = 4, scalar) writeonly buffer Ids { uint ids[]; };
layout(binding = 5, scalar) writeonly buffer Draws { DrawCommand draws[4]; };

void main() {
    const uint slot = triangleSlot(gl_WorkGroupID, gl_NumWorkGroups, gl_LocalInvocationID.x);
    if (slot < 4) {
        const uint begin = offsets[counts.binStarts[slot]];
        const uint end = offsets[counts.binStarts[slot + 1]];
        draws[slot] = DrawCommand(3 * (end - begin), 1, 3 * begin, 0);
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
    ids[offsets[which] + rank] = visible[which] << LS_TRIANGLE_BITS | t;
}

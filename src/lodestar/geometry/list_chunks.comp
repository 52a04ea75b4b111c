// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/gpu_types.h"
#include "cull_params.h"

// One thread a chunk: lists the visible ones in order.
layout(local_size_x = LS_SPAN) in;

layout(binding = 0, scalar) uniform Params { CullParams params; };
layout(binding = 1, scalar) readonly buffer Offsets { uint offsets[]; };
layout(binding = 2, scalar) writeonly buffer Visible { uint visible[]; };
layout(binding = 3, scalar) readonly buffer Counts { CullCounts counts; };
layout(push_constant, scalar) uniform Push { ScanParams scanned; };

uint offsetOf(uint i) { return offsets[i] + offsets[scanned.totals + i / LS_BLOCK]; }

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_SPAN,
                                    gl_LocalInvocationID.x);
    if (index >= params.chunkCount) return;
    const uint at = offsetOf(index);
    const uint next = index + 1 < params.chunkCount
                          ? offsetOf(index + 1)
                          : counts.lists[LS_LIST_INSTANCES].count / LS_CHUNK;
    if (next != at) visible[at] = index;
}

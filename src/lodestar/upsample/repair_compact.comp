// SPDX-License-Identifier: Apache-2.0
#version 460
#include "upsample_params.h"

// A fixed number of threads walks the listed pixels and gathers those that are kept.
layout(local_size_x = 64) in;

layout(binding = 0, scalar) buffer Header { RepairHeader repair; };
layout(binding = 1, scalar) readonly buffer Listed { uint listed[]; };
layout(binding = 2, scalar) writeonly buffer Kept { uint kept[]; };

void main() {
    const uint threads = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < repair.listed; i += threads) {
        const uint entry = listed[i];
        if (entry >> LS_REPAIR_INDEX_BITS < repair.cut) continue;
        kept[atomicAdd(repair.kept, 1)] = entry & ((1u << LS_REPAIR_INDEX_BITS) - 1);
    }
}

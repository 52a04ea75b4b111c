// SPDX-License-Identifier: Apache-2.0
#version 460
#include "upsample_params.h"

// A fixed number of threads walks the listed pixels and gathers those that are kept.
layout(local_size_x = 64) in;

layout(binding = 0, scalar) buffer Header { RepairHeader repair; };
layout(binding = 1, scalar) readonly buffer Listed { uint listed[]; };
layout(binding = 2, scalar) writeonly buffer Kept { uint kept[]; };

/// A number that looks like chance, the same for a pixel every time (PCG; Jarzynski & Olano 2020).
uint lot(uint index) {
    const uint state = index * 747796405u + 2891336453u;
    const uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

void main() {
    const uint threads = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < repair.listed; i += threads) {
        const uint bin = listed[i] >> LS_REPAIR_INDEX_BITS;
        const uint index = listed[i] & ((1u << LS_REPAIR_INDEX_BITS) - 1);
        const bool drawn = bin + 1 == repair.cut && lot(index) < repair.partOf;
        if (bin < repair.cut && !drawn) continue;
        const uint slot = atomicAdd(repair.kept, 1);
        kept[slot] = index;
        if (slot % 64 == 0) atomicMax(repair.groups[0], slot / 64 + 1);
        repair.groups[1] = 1;
        repair.groups[2] = 1;
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "upsample_params.h"

// How many of the listed pixels lie in each bin. A fixed number of threads walks the list, a
// workgroup counts on its own.
layout(local_size_x = 64) in;

layout(binding = 0, scalar) buffer Header { RepairHeader repair; };
layout(binding = 1, scalar) readonly buffer Listed { uint listed[]; };

shared uint bins[LS_REPAIR_BINS];

void main() {
    for (uint i = gl_LocalInvocationIndex; i < LS_REPAIR_BINS; i += gl_WorkGroupSize.x) bins[i] = 0;
    barrier();
    const uint threads = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < repair.listed; i += threads)
        atomicAdd(bins[listed[i] >> LS_REPAIR_INDEX_BITS], 1);
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < LS_REPAIR_BINS; i += gl_WorkGroupSize.x)
        if (bins[i] > 0) atomicAdd(repair.bins[i], bins[i]);
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "cull_params.h"

// Exclusive prefix sum within blocks of LS_BLOCK values, whose number is on the device; the totals
// of the blocks go behind the values. What is before a value is the value now plus the total of its
// block, once scan_totals.comp has summed those.
layout(local_size_x = 64) in;

layout(binding = 0, scalar) buffer Values { uint values[]; };
layout(binding = 1, scalar) readonly buffer Counts { CullCounts counts; };
layout(push_constant, scalar) uniform Push { ScanParams params; };

const uint kOwn = LS_BLOCK / 64;
shared uint sums[64];

void main() {
    const uint block = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    const uint thread = gl_LocalInvocationID.x;
    const uint count = counts.lists[params.source].count;
    const uint first = block * LS_BLOCK + thread * kOwn;
    uint own[kOwn];
    uint sum = 0;
    for (uint i = 0; i < kOwn; ++i) {
        own[i] = sum;
        if (first + i < count) sum += values[first + i];
    }
    sums[thread] = sum;
    barrier();
    for (uint step = 1; step < 64; step *= 2) {
        const uint left = thread >= step ? sums[thread - step] : 0;
        barrier();
        sums[thread] += left;
        barrier();
    }
    const uint before = thread > 0 ? sums[thread - 1] : 0;
    for (uint i = 0; i < kOwn; ++i)
        if (first + i < count) values[first + i] = before + own[i];
    if (thread == 63 && block * LS_BLOCK < count) values[params.totals + block] = sums[63];
}

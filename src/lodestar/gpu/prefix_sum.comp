// SPDX-License-Identifier: Apache-2.0
#version 460
#include "prefix_sum_params.h"

// Exclusive prefix sum, one block of 1024 a workgroup. Mode 0 scans blocks and writes their totals;
// mode 1 adds each block's scanned total to its values.
layout(local_size_x = 256) in;
layout(constant_id = 0) const uint kAddTotals = 0;

layout(binding = 0, scalar) buffer Values { uint values[]; };
layout(push_constant, scalar) uniform Push { PrefixSumParams params; };

shared uint sums[256];

void main() {
    const uint block = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    const uint thread = gl_LocalInvocationID.x;
    const uint first = block * LS_SCAN_BLOCK + thread * 4;
    const uint blocks = (params.count + LS_SCAN_BLOCK - 1) / LS_SCAN_BLOCK;

    if (kAddTotals != 0) {
        if (block >= blocks) return;
        const uint total = values[params.blockTotals + block];
        for (uint i = 0; i < 4; ++i)
            if (first + i < params.count) values[params.source + first + i] += total;
        return;
    }

    uint own[4];
    uint sum = 0;
    for (uint i = 0; i < 4; ++i) {
        own[i] = sum;
        if (first + i < params.count) sum += values[params.source + first + i];
    }
    sums[thread] = sum;
    barrier();
    for (uint step = 1; step < 256; step *= 2) {
        const uint left = thread >= step ? sums[thread - step] : 0;
        barrier();
        sums[thread] += left;
        barrier();
    }
    const uint before = thread > 0 ? sums[thread - 1] : 0;
    for (uint i = 0; i < 4; ++i)
        if (first + i < params.count) values[params.source + first + i] = before + own[i];
    if (thread == 255 && block < blocks) values[params.blockTotals + block] = sums[255];
}

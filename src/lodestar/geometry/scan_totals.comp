// SPDX-License-Identifier: Apache-2.0
#version 460
#include "cull_params.h"

// One workgroup: sums the totals of the blocks, and says how long the list is that the scanned
// values count, with the dispatches over it.
layout(local_size_x = 64) in;

layout(binding = 0, scalar) buffer Values { uint values[]; };
layout(binding = 1, scalar) buffer Counts { CullCounts counts; };
layout(push_constant, scalar) uniform Push { ScanParams params; };

shared uint sums[64];

uvec3 inRows(uint groups) {
    const uint rows = (groups + 32767) / 32768;
    return uvec3(rows == 0 ? 0 : (groups + rows - 1) / rows, rows, 1);
}

void main() {
    const uint thread = gl_LocalInvocationID.x;
    const uint blocks = (counts.lists[params.source].count + LS_BLOCK - 1) / LS_BLOCK;
    const uint own = (blocks + 63) / 64, first = thread * own;
    uint sum = 0;
    for (uint i = 0; i < own; ++i)
        if (first + i < blocks) sum += values[params.totals + first + i];
    sums[thread] = sum;
    barrier();
    for (uint step = 1; step < 64; step *= 2) {
        const uint left = thread >= step ? sums[thread - step] : 0;
        barrier();
        sums[thread] += left;
        barrier();
    }
    uint before = thread > 0 ? sums[thread - 1] : 0;
    for (uint i = 0; i < own; ++i) {
        if (first + i >= blocks) break;
        const uint value = values[params.totals + first + i];
        values[params.totals + first + i] = before;
        before += value;
    }
    if (thread != 63) return;

    const uint taken =
        params.before == params.result ? 0 : counts.lists[params.before].count;
    const uint total = sums[63] * params.times, capacity = params.capacity - taken;
    const uint count = min(total, capacity);
    const uvec3 groups = inRows((count + LS_SPAN - 1) / LS_SPAN);
    const uvec3 scans = inRows((count + LS_BLOCK - 1) / LS_BLOCK);
    const uvec3 words = inRows(max((count + LS_WORD_CLUSTERS - 1) / LS_WORD_CLUSTERS, 1));
    for (int i = 0; i < 3; ++i) {
        counts.lists[params.result].groups[i] = groups[i];
        counts.lists[params.result].blocks[i] = scans[i];
        counts.lists[params.result].words[i] = words[i];
    }
    counts.lists[params.result].count = count;
    counts.lists[params.result].dropped = total - count;
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/types.h"
#include "cull_params.h"

// One thread a cluster: lists the visible ones in order, says how many there are, and clears what
// the triangles of each will be counted in.
layout(local_size_x = 64) in;

layout(binding = 0, scalar) readonly buffer Offsets { uint offsets[]; };  // flags, prefix-summed
layout(binding = 1, scalar) writeonly buffer Visible { uint visible[]; };
layout(binding = 2, scalar) writeonly buffer Triangles { uint triangleCounts[]; };
layout(binding = 3, scalar) writeonly buffer Masks { uvec4 masks[]; };
layout(binding = 4, scalar) writeonly buffer Counts { VisibleCounts counts; };
layout(push_constant, scalar) uniform Push { CompactParams params; };

void main() {
    const uint index = gl_GlobalInvocationID.x;
    const uint clusterCount = params.binStarts[4];
    if (index > clusterCount) return;
    triangleCounts[index] = 0;
    if (index == clusterCount) {
        const uint total = offsets[clusterCount];
        const uint perGroup = LS_CULL_GROUP / LS_CLUSTER_SLOTS;
        const uint groups = max((total + perGroup - 1) / perGroup, 1);  // one writes the draws
        const uint rows = (groups + 32767) / 32768;
        counts.groups[0] = (groups + rows - 1) / rows;
        counts.groups[1] = rows;
        counts.groups[2] = 1;
        counts.clusters = total;
        for (int i = 0; i < 5; ++i) counts.binStarts[i] = offsets[params.binStarts[i]];
        return;
    }
    masks[index] = uvec4(0);
    const uint at = offsets[index];
    if (offsets[index + 1] != at) visible[at] = index;
}

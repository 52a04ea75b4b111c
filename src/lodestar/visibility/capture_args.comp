// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../geometry/cull_params.h"
#include "capture_compute_params.h"

// From the draws of geometry's list to the two queues: which listed triangles, how many workgroups.
layout(local_size_x = 1) in;

struct DrawCommand {
    uint vertexCount, instanceCount, firstVertex, firstInstance;
};

layout(binding = 0, scalar) readonly buffer Draws { DrawCommand draws[8]; };  // four a phase
layout(binding = 1, scalar) writeonly buffer Opaque { CaptureQueueCounts opaque; };
layout(binding = 2, scalar) writeonly buffer Masked { CaptureQueueCounts masked; };
layout(binding = 3, scalar) readonly buffer Lists { CullCounts lists; };
layout(push_constant, scalar) uniform Push { CaptureArgsParams params; };

CaptureQueueCounts queueOf(uint bin, bool beyond) {
    const uint first = draws[bin].firstVertex / 3;
    const uint count = (draws[bin].vertexCount + draws[bin + 1].vertexCount) / 3;
    const uint groups = (count + LS_CAPTURE_GROUP - 1) / LS_CAPTURE_GROUP;
    const uint rows = max((groups + 32767) / 32768, 1);
    const uint columns = (groups + rows - 1) / rows;
    CaptureQueueCounts q;
    q.groups = uint[3](params.capacity > 0 ? columns : 0, rows, 1);
    q.slowGroups = uint[3](beyond ? columns : 0, rows, 1);
    q.clipGroups = uint[3](0, 1, 1);
    q.splitGroups = uint[3](0, 1, 1);
    q.tileGroups = uint[3](0, 1, 1);
    q.first = first;
    q.count = count;
    q.clipped = 0;
    q.large = 0;
    q.tiles = 0;
    q.jobs = 0;
    return q;
}

void main() {
    const uint clusters = lists.lists[LS_LIST_CLUSTERS].count +
                          (params.firstDraw > 0 ? lists.lists[LS_LIST_CLUSTERS_2].count : 0);
    const bool beyond = clusters > params.capacity;
    opaque = queueOf(params.firstDraw, beyond);
    masked = queueOf(params.firstDraw + 2, beyond);
}

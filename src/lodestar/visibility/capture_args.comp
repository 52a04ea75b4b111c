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

/// One thread a triangle.
uint[3] groupsOf(uint triangles) {
    const uint groups = (triangles + LS_CAPTURE_GROUP - 1) / LS_CAPTURE_GROUP;
    const uint rows = max((groups + 32767) / 32768, 1);
    return uint[3]((groups + rows - 1) / rows, rows, 1);
}

CaptureQueueCounts queueOf(uint bin, uint projectedEnd) {
    const uint first = draws[bin].firstVertex / 3;
    const uint count = (draws[bin].vertexCount + draws[bin + 1].vertexCount) / 3;
    CaptureQueueCounts q;
    q.projected = clamp(projectedEnd, first, first + count) - first;
    q.groups = groupsOf(q.projected);
    q.slowGroups = groupsOf(count - q.projected);
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
    const uint end = params.projected != 0 ? lists.projected[params.firstDraw / 4] : 0;
    opaque = queueOf(params.firstDraw, end);
    masked = queueOf(params.firstDraw + 2, end);
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute_params.h"

// From the draws of geometry's list to the two queues: which listed triangles, how many workgroups.
layout(local_size_x = 1) in;

struct DrawCommand {
    uint vertexCount, instanceCount, firstVertex, firstInstance;
};

layout(binding = 0, scalar) readonly buffer Draws { DrawCommand draws[8]; };  // four a phase
layout(binding = 1, scalar) writeonly buffer Opaque { CaptureQueueCounts opaque; };
layout(binding = 2, scalar) writeonly buffer Masked { CaptureQueueCounts masked; };
layout(push_constant) uniform Push { uint firstDraw; };

CaptureQueueCounts queueOf(uint bin) {
    const uint first = draws[bin].firstVertex / 3;
    const uint count = (draws[bin].vertexCount + draws[bin + 1].vertexCount) / 3;
    const uint groups = (count + LS_CAPTURE_GROUP - 1) / LS_CAPTURE_GROUP;
    const uint rows = max((groups + 32767) / 32768, 1);
    CaptureQueueCounts q;
    q.groups = uint[3]((groups + rows - 1) / rows, rows, 1);
    q.first = first;
    q.count = count;
    q.clipped = 0;
    q.large = 0;
    q.jobs = 0;
    return q;
}

void main() {
    opaque = queueOf(firstDraw);
    masked = queueOf(firstDraw + 2);
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One workgroup a cluster: writes the indices and ids of its triangles where the prefix sum says.
layout(local_size_x = 64) in;

struct DrawCommand {
    uint indexCount, instanceCount, firstIndex;
    int vertexOffset;
    uint firstInstance;
};

layout(binding = 7, scalar) readonly buffer Offsets { uint offsets[]; };
layout(binding = 8, scalar) writeonly buffer Indices { uint indices[]; };
layout(binding = 9, scalar) writeonly buffer Ids { uint ids[]; };
layout(binding = 10, scalar) writeonly buffer Draws { DrawCommand draws[4]; };
layout(push_constant, scalar) uniform Push { EmitParams params; };

void main() {
    const uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
    if (index >= params.binStarts[4]) return;
    const uint thread = gl_LocalInvocationID.x;
    if (index == 0) {
        if (thread >= 4) return;
        const uint begin = offsets[params.binStarts[thread]];
        const uint end = offsets[params.binStarts[thread + 1]];
        draws[thread] = DrawCommand(3 * (end - begin), 1, 3 * begin, 0, 0);
        return;
    }
    const uint first = offsets[index];
    const uint count = offsets[index + 1] - first;
    if (count == 0) return;
    const GpuCluster cluster = loadCluster(index);
    const bool reflected =
        (loadInstance(cluster.instance).flags & LS_INSTANCE_REFLECTED) != 0;
    for (uint t = thread; t < count; t += 64) {
        const uint word = loadStoredTriangle(cluster.triangles + t).local;
        const uint b = word >> 8 & 255, c = word >> 16 & 255;
        const uint base = index << LS_VERTEX_BITS;
        const uint at = 3 * (first + t);
        indices[at] = base | (word & 255);
        indices[at + 1] = base | (reflected ? c : b);
        indices[at + 2] = base | (reflected ? b : c);
        ids[first + t] = index << LS_TRIANGLE_BITS | t;
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "capture_ss_params.h"

layout(constant_id = 2) const uint kMasked = 0;

layout(push_constant, scalar) uniform Push { CaptureParams params; };

layout(location = 0) out vec2 uv0;
layout(location = 1) out vec2 uv1;
layout(location = 2) out float alpha;

void main() {
    const uint index = uint(gl_VertexIndex);
    const GpuCluster cluster = sceneClusters[index >> LS_VERTEX_BITS];
    const uint entry =
        sceneMeshlets[cluster.meshlet].vertexOffset + (index & LS_VERTEX_MASK);
    const uint vertex = sceneMeshletVertices[entry];
    const vec3 world =
        transformPoint(sceneInstances[cluster.instance], sceneVertices[vertex].position);
    gl_Position = params.clipFromWorld * vec4(world, 1);
    if (kMasked != 0) {
        uv0 = sceneVertices[vertex].uv0;
        uv1 = sceneVertices[vertex].uv1;
        alpha = unpackUnorm4x8(sceneVertices[vertex].color).a;
    }
}

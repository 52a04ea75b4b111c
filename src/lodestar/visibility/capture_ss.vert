// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "capture_ss_params.h"

layout(constant_id = 1) const uint kMasked = 0;

layout(binding = 11) uniform samplerBuffer secondUvs;
layout(push_constant, scalar) uniform Push { CaptureParams params; };

layout(location = 0) out vec2 uv0;
layout(location = 1) out vec2 uv1;
layout(location = 2) out float alpha;

void main() {
    const uint index = uint(gl_VertexIndex);
    const GpuCluster cluster = loadCluster(index >> LS_VERTEX_BITS);
    const uint vertex = loadMeshletVertex(cluster.vertices + (index & LS_VERTEX_MASK));
    const vec3 world =
        transformPoint(loadInstance(cluster.instance), loadVertex(vertex).position);
    gl_Position = params.clipFromWorld * vec4(world, 1);
    if (kMasked != 0) {
        const GpuVertexAttributes attributes = loadAttributes(vertex);
        uv0 = attributes.uv;
        uv1 = texelFetch(secondUvs, int(vertex)).xy;
        alpha = unpackUnorm4x8(attributes.color).a;
    }
}

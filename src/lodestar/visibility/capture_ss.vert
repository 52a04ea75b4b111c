// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "capture_ss_params.h"

layout(constant_id = 1) const uint kMasked = 0;

layout(binding = 6) uniform usamplerBuffer ids;
layout(binding = 9) uniform samplerBuffer secondUvs;
layout(push_constant, scalar) uniform Push { CaptureParams params; };

layout(location = 0) flat out uint id;
layout(location = 1) out vec2 uv0;
layout(location = 2) out vec2 uv1;
layout(location = 3) out float alpha;

// Three vertices a listed triangle. Without an index buffer each can carry the id, which
// gl_PrimitiveID would otherwise have to look up, at several times the cost on Mesa's CPU driver.
void main() {
    id = texelFetch(ids, gl_VertexIndex / 3).x;
    const GpuCluster cluster = loadCluster(id >> LS_TRIANGLE_BITS);
    const GpuInstance instance = loadInstance(cluster.instance);
    const uint vertex = cornerVertex(cluster, instance, id, uint(gl_VertexIndex % 3));
    const vec3 world = transformPoint(instance, loadVertex(vertex).position);
    gl_Position = params.clipFromWorld * vec4(world, 1);
    if (kMasked != 0) {
        const GpuVertexAttributes attributes = loadAttributes(vertex);
        uv0 = attributes.uv;
        uv1 = texelFetch(secondUvs, int(vertex)).xy;
        alpha = unpackUnorm4x8(attributes.color).a;
    }
}

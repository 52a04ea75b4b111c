// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_GOOGLE_include_directive : require
#include <lodestar/scene/scene.glsl>
#include "gbuffer_params.h"

layout(constant_id = 0) const uint kUvTransforms = 1;
layout(constant_id = 3) const uint kNormalArrays = 255;

layout(binding = 8) uniform samplerBuffer secondUvs;
layout(binding = 9) uniform usamplerBuffer ids;
layout(push_constant, scalar) uniform Push { GBufferParams params; };

layout(location = 0) out vec2 uv0;
layout(location = 1) out vec2 uv1;
layout(location = 2) out vec4 color;
layout(location = 3) out vec3 normal;   // world, not normalised
layout(location = 4) out vec3 tangent;  // the same
layout(location = 5) flat out float handedness;
layout(location = 6) flat out uint materialIndex;
layout(location = 7) flat out uint triangleId;

void main() {
    const uint id = texelFetch(ids, gl_VertexIndex / 3).x;
    triangleId = id;
    const GpuCluster cluster = loadCluster(id >> LS_TRIANGLE_BITS);
    const GpuInstance instance = loadInstance(cluster.instance);
    const uint number = cornerVertex(cluster, instance, id, uint(gl_VertexIndex % 3));
    const GpuVertex vertex = loadVertex(number);
    const GpuVertexAttributes attributes = loadAttributes(number);
    gl_Position = params.clipFromWorld * vec4(transformPoint(instance, vertex.position), 1);
    uv0 = attributes.uv;
    color = unpackUnorm4x8(attributes.color);
    normal = transformNormal(instance, unpackNormal(vertex.normal));
    materialIndex = cluster.material;
    uv1 = vec2(0);
    if (kUvTransforms != 0) uv1 = texelFetch(secondUvs, int(number)).xy;
    tangent = vec3(0);
    handedness = 1;
    if (kNormalArrays != 0) {
        const vec4 stored = unpackTangent(attributes.tangent);
        tangent = transformDirection(instance, stored.xyz);
        handedness = (instance.flags & LS_INSTANCE_REFLECTED) != 0 ? -stored.w : stored.w;
    }
}

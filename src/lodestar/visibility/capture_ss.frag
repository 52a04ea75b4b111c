// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "capture_ss_params.h"
#define LS_TEXTURE_BINDING 9
#include "../scene/material.glsl"

layout(constant_id = 2) const uint kMasked = 0;
layout(constant_id = 3) const uint kWriteId = 1;

struct DrawCommand {
    uint indexCount, instanceCount, firstIndex;
    int vertexOffset;
    uint firstInstance;
};

layout(binding = 6, scalar) readonly buffer Ids { uint ids[]; };
layout(binding = 7, scalar) readonly buffer Draws { DrawCommand draws[4]; };
layout(binding = 8, scalar) readonly buffer Materials { GpuMaterial materials[]; };
layout(push_constant, scalar) uniform Push { CaptureParams params; };

layout(location = 0) in vec2 uv0;
layout(location = 1) in vec2 uv1;
layout(location = 2) in float alpha;
layout(location = 0) out uint outId;

void main() {
    const uint id = ids[draws[params.bin].firstIndex / 3 + uint(gl_PrimitiveID)];
    if (kMasked != 0) {
        const uint meshlet = sceneClusters[id >> LS_TRIANGLE_BITS].meshlet;
        const GpuMaterial material = materials[sceneMeshlets[meshlet].material];
        const TexturePoint p0 = TexturePoint(uv0, dFdx(uv0), dFdy(uv0));
        const TexturePoint p1 = TexturePoint(uv1, dFdx(uv1), dFdy(uv1));
        const float a = sampleTexture(material.baseColorTexture, p0, p1).a;
        if (a * material.baseColor.a * alpha < material.alphaCutoff) discard;
    }
    if (kWriteId != 0) outId = id;
}

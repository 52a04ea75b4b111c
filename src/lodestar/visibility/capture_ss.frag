// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#define LS_MATERIAL_BINDING 7
#define LS_TEXTURE_BINDING 8
#include "../scene/material.glsl"
#include "capture_ss_params.h"

layout(constant_id = 1) const uint kMasked = 0;
layout(constant_id = 2) const uint kWriteId = 1;
layout(constant_id = 3) const uint kBaseColorArrays = 255;

layout(push_constant, scalar) uniform Push { CaptureParams params; };

layout(location = 0) flat in uint id;
layout(location = 1) in vec2 uv0;
layout(location = 2) in vec2 uv1;
layout(location = 3) in float alpha;
layout(location = 0) out uint outId;

void main() {
    if (kMasked != 0) {
        TexturePlace place;
        place.set0 = TexturePoint(uv0, dFdx(uv0) * params.textureScale.x,
                                  dFdy(uv0) * params.textureScale.y);
        place.set1 = TexturePoint(uv1, dFdx(uv1) * params.textureScale.x,
                                  dFdy(uv1) * params.textureScale.y);
        place.material = loadCluster(id >> LS_TRIANGLE_BITS).material;
        const GpuMaterial material = loadMaterial(place.material);
        const float a = sampleTexture(material.baseColorTexture, 0, place, kBaseColorArrays).a;
        if (a * material.baseColor.a * alpha < material.alphaCutoff) discard;
    }
    if (kWriteId != 0) outId = id;
}

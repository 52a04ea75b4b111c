// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#define LS_MATERIAL_BINDING 7
#define LS_TEXTURE_BINDING 8
#include "../scene/material.glsl"
#include "opaque_depth.glsl"
#include "peel_params.h"

// The nearest blended surface behind those peeled before and before what is opaque.
layout(constant_id = 2) const uint kFirst = 1;
layout(constant_id = 3) const uint kBaseColorArrays = 255;

layout(binding = 10) uniform sampler2D opaqueDepth;  // linear
layout(binding = 11) uniform sampler2D peeled;       // depth buffer of the peel before
layout(push_constant, scalar) uniform Push { PeelParams params; };

layout(location = 0) flat in uint id;
layout(location = 1) in vec2 uv0;
layout(location = 2) in vec2 uv1;
layout(location = 3) in float alpha;
layout(location = 0) out uint outId;
layout(location = 1) out float outAlpha;

const float kSlack = 2e-5;  // relative: decals lie in the surface they are on

void main() {
    TexturePlace place;
    place.set0 = TexturePoint(uv0, dFdx(uv0) * params.textureScale.x,
                              dFdy(uv0) * params.textureScale.y);
    place.set1 = TexturePoint(uv1, dFdx(uv1) * params.textureScale.x,
                              dFdy(uv1) * params.textureScale.y);
    place.material = loadCluster(id >> LS_TRIANGLE_BITS).material;
    const GpuMaterial material = loadMaterial(place.material);
    if ((material.flags & LS_MATERIAL_BLEND) == 0) discard;
    const float a = sampleTexture(material.baseColorTexture, 0, place, kBaseColorArrays).a *
                    material.baseColor.a * alpha;
    // From the cutoff on it is opaque, and has been drawn as such.
    if (a >= material.alphaCutoff || a < 1.0 / 512) discard;
    if (kFirst == 0 && gl_FragCoord.z >= texelFetch(peeled, ivec2(gl_FragCoord.xy), 0).x) discard;
    const float opaque =
        opaqueNearness(opaqueDepth, gl_FragCoord.xy * params.toOpaque, params.opaqueSize);
    if (gl_FragCoord.w < opaque * (1 - kSlack)) discard;  // w is 1 / depth
    outId = id;
    outAlpha = a;
}

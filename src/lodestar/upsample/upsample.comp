// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/octahedral.h"
#include "../shared/tiles.glsl"
#include "upsample_params.h"

// Joint bilateral upsampling, one thread a pixel of O.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kDomain = LS_DOMAIN_TENT;
layout(constant_id = 1) const uint kRange = 1;   // 0: σn = σz = ∞, the plain domain filter
layout(constant_id = 2) const uint kMerge = 0;   // 1: write some channels, keep the others
layout(constant_id = 3) const uint kRepair = 0;  // 1: list the pixels that no tap is like

layout(binding = 0) uniform usampler2D coarse;
layout(binding = 1) uniform sampler2D depth;
layout(binding = 2) uniform usampler2D normal;
layout(binding = 3, rgba16f) uniform image2D terms;
layout(binding = 4, scalar) buffer Header { RepairHeader repair; };
layout(binding = 5, scalar) writeonly buffer List { uint listed[]; };
layout(binding = 6) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push { UpsampleParams params; };

#include "list_repair.glsl"
#include "reconstruct.glsl"

void write(ivec2 pixel, vec4 values) {
    if (kMerge != 0) {
        const bvec4 chosen = notEqual(uvec4(params.terms) & uvec4(1, 2, 4, 8), uvec4(0));
        values = mix(imageLoad(terms, pixel), values, chosen);
    }
    imageStore(terms, pixel, values);
}

void main() {
    const ivec2 pixel = pixelOfThread(tiles);
    if (any(greaterThanEqual(pixel, ivec2(params.fullSize)))) return;
    const float z = texelFetch(depth, pixel, 0).x;
    Likeness like;
    const vec3 n = unpackNormal(texelFetch(normal, pixel, 0).x);
    write(pixel, reconstruct(pixel, z, n, params.from, like));
    if (kRepair != 0 && z > 0) listForRepair(pixel, params.fullSize, like, params.from);
}

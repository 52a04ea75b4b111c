// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/tiles.glsl"
#include "../upsample/upsample_params.h"
#include "combine.glsl"
#include "combine_params.h"

// One thread a pixel of grid O, with terms reconstructed from grid S.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 4) const uint kDomain = LS_DOMAIN_TENT;
layout(constant_id = 5) const uint kRange = 1;
layout(constant_id = 6) const uint kRepair = 0;  // 1: list the pixels that no tap is like

layout(binding = 8) uniform usampler2D coarse;
layout(binding = 9, scalar) buffer Header { RepairHeader repair; };
layout(binding = 10, scalar) writeonly buffer List { uint listed[]; };
layout(binding = 11) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push { CombineFromSParams params; };

#include "../upsample/list_repair.glsl"
#include "../upsample/reconstruct.glsl"

void main() {
    const ivec2 pixel = pixelOfThread(tiles);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const float depth = texelFetch(surfaceDepth, pixel, 0).x;
    Likeness like;
    const vec3 normal = unpackNormal(texelFetch(surfaceMaterial, pixel, 0).w);
    const vec4 term =
        reconstruct(pixel, depth, mat3(view.viewFromWorld) * normal, params.from, like);
    if (kRepair != 0 && depth > 0) listForRepair(pixel, params.size, like, params.from);
    combine(pixel, centreOf(pixel, params.size), depth, term);
}

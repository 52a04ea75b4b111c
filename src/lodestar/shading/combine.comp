// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/tiles.glsl"
#include "combine.glsl"
#include "combine_params.h"

// One thread a pixel of grid O, with terms of grid O.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 4) const uint kPoints = 0;  // 1: at `points`, not at the centres of pixels

layout(binding = 8) uniform sampler2D terms;
layout(binding = 9) uniform sampler2D points;  // NDC
layout(binding = 10) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push {
    CombineParams params;
};

void main() {
    const ivec2 pixel = pixelOfThread(tiles);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const vec2 ndc = kPoints != 0 ? texelFetch(points, pixel, 0).xy : centreOf(pixel, params.size);
    combine(pixel, ndc, texelFetch(surfaceDepth, pixel, 0).x, texelFetch(terms, pixel, 0));
}

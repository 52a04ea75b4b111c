// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../upsample/upsample_params.h"
#include "combine.glsl"
#include "combine_params.h"

// One thread a pixel that was repaired.
layout(local_size_x = 64) in;

layout(binding = 8) uniform sampler2D terms;
layout(binding = 9, scalar) readonly buffer Header { RepairHeader repair; };
layout(binding = 10, scalar) readonly buffer Kept { uint kept[]; };
layout(push_constant, scalar) uniform Push { CombineParams params; };

void main() {
    if (gl_GlobalInvocationID.x >= repair.kept) return;
    const uint index = kept[gl_GlobalInvocationID.x];
    const ivec2 pixel = ivec2(index % params.size.x, index / params.size.x);
    combine(pixel, centreOf(pixel, params.size), texelFetch(surfaceDepth, pixel, 0).x,
            texelFetch(terms, pixel, 0));
}

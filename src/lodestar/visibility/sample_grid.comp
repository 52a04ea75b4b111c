// SPDX-License-Identifier: Apache-2.0
#version 460
#include "sample_grid_params.h"

// One thread a texel of grid S.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2D ids;
layout(binding = 1, r32ui) writeonly uniform uimage2D outIds;
layout(binding = 2, rg32f) writeonly uniform image2D outPoints;
layout(push_constant, scalar) uniform Push {
    SampleGridParams params;
};

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.size)))) return;
    // The last row and column may reach past the picture; their centres stay inside.
    const vec2 centre = min((vec2(texel) + 0.5) * params.rate, vec2(params.fullSize) - 0.5);
    imageStore(outIds, texel, texelFetch(ids, ivec2(centre), 0));
    imageStore(outPoints, texel, vec4(centre / vec2(params.fullSize) * 2 - 1, 0, 0));
}

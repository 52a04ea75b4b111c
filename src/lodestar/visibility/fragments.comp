// SPDX-License-Identifier: Apache-2.0
#version 460
#include "fragments_params.h"
layout(constant_id = 0) const uint kSide = 8;
#define LS_HEADS_BINDING 0
#define LS_LISTS_BINDING 1
#include "record.glsl"

// The main fragment of each pixel of grid B, one thread a pixel: its representative, at the centroid
// of its samples. Pixels that list more are listed in turn.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 2, r32ui) writeonly uniform uimage2D outIds;
layout(binding = 3, rg32f) writeonly uniform image2D outPoints;  // NDC
layout(binding = 4, scalar) buffer Counts { FragmentCounts counts; };
layout(binding = 5, scalar) writeonly buffer Mixed { uint mixed[]; };
layout(push_constant, scalar) uniform Push { FragmentsParams params; };

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, params.base))) return;
    const uint at = pixel.y * params.base.x + pixel.x;
    const Head head = loadHead(at);
    const List list = loadList(head);
    if (head.listed) mixed[atomicAdd(counts.mixed, 1)] = at;
    const vec2 inside = head.listed ? centroidOf(listedMask(list, 0)) : vec2(0.5);
    imageStore(outIds, ivec2(pixel), uvec4(head.id));
    imageStore(outPoints, ivec2(pixel),
               vec4((vec2(pixel) + inside) / vec2(params.base) * 2 - 1, 0, 0));
}

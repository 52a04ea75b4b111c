// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/types.h"

// One thread a sample: its id, from the words of a capture in compute.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usamplerBuffer words;
layout(binding = 1, r32ui) writeonly uniform uimage2D ids;
layout(push_constant, scalar) uniform Push { uvec2 size; };

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, size))) return;
    imageStore(ids, ivec2(at), uvec4(texelFetch(words, int(at.y * size.x + at.x)).x, 0, 0, 0));
}

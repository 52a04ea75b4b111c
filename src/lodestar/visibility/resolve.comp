// SPDX-License-Identifier: Apache-2.0
#version 460
#include "fragments_params.h"

// Blends what the surfaces of a pixel radiate by their samples, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kSamples = 64;

layout(binding = 0) uniform sampler2D mainRadiance;
layout(binding = 1) uniform sampler2D moreRadiance;
layout(binding = 2, scalar) readonly buffer Counts { uint counts[]; };
layout(binding = 3, scalar) readonly buffer Weights { uint weights[]; };
layout(binding = 4, rgba16f) writeonly uniform image2D outRadiance;

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    const ivec2 size = textureSize(mainRadiance, 0);
    if (any(greaterThanEqual(pixel, size))) return;
    const uint at = uint(pixel.y * size.x + pixel.x);
    const uint room = uint(textureSize(moreRadiance, 0).y) * LS_FRAGMENT_ROW;
    const uint end = min(counts[at + 1], room);
    vec4 sum = vec4(0);
    uint others = 0;
    for (uint i = counts[at]; i < end; ++i) {
        const uint weight = weights[i];
        sum += float(weight) *
               texelFetch(moreRadiance, ivec2(i % LS_FRAGMENT_ROW, i / LS_FRAGMENT_ROW), 0);
        others += weight;
    }
    sum += float(kSamples - others) * texelFetch(mainRadiance, pixel, 0);
    imageStore(outRadiance, pixel, sum / kSamples);
}

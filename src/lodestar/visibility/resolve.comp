// SPDX-License-Identifier: Apache-2.0
#version 460
#include "fragments_params.h"

// Adds the further fragments to their pixels, one thread a pixel that has some.
layout(local_size_x = 64) in;

layout(constant_id = 0) const uint kSamples = 64;

layout(binding = 0) uniform sampler2D moreRadiance;
layout(binding = 1, scalar) readonly buffer Counts { FragmentCounts counts; };
layout(binding = 2, scalar) readonly buffer Weights { uint weights[]; };
layout(binding = 3, scalar) readonly buffer Further { FurtherPixel further[]; };
layout(binding = 4, rgba16f) uniform image2D radiance;
layout(push_constant, scalar) uniform Push { FragmentsParams params; };

void main() {
    const uint thread = gl_GlobalInvocationID.x;
    if (thread >= counts.pixels) return;
    const FurtherPixel f = further[thread];
    vec4 sum = vec4(0);
    for (uint i = f.first; i < f.first + f.count; ++i)
        sum += float(weights[i]) *
               texelFetch(moreRadiance, ivec2(i % LS_FRAGMENT_ROW, i / LS_FRAGMENT_ROW), 0);
    const ivec2 pixel = ivec2(f.pixel % params.base.x, f.pixel / params.base.x);
    imageStore(radiance, pixel, imageLoad(radiance, pixel) + sum / kSamples);
}

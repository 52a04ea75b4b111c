// SPDX-License-Identifier: Apache-2.0
#version 460
#include "reduce_params.h"

// A supersampled picture filtered down, one thread a pixel of the small one.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D large;
layout(binding = 1, rgba16f) writeonly uniform image2D small;
layout(push_constant, scalar) uniform Push { ReduceParams params; };

/// Mitchell & Netravali 1988, B = C = 1/3.
float mitchell(float x) {
    x = abs(x);
    return x < 1   ? (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6
           : x < 2 ? (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6
                   : 0;
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(small)))) return;
    const int n = int(params.factor);
    const bool wide = params.filterId == LS_REDUCE_MITCHELL;
    const int reach = wide ? (3 * n) / 2 : 0;  // past the pixel's own
    const ivec2 last = textureSize(large, 0) - 1;
    vec4 sum = vec4(0);
    float weights = 0;
    for (int y = -reach; y < n + reach; ++y) {
        const float wy = wide ? mitchell((float(y) + 0.5) / float(n) - 0.5) : 1;
        for (int x = -reach; x < n + reach; ++x) {
            const float w = wide ? wy * mitchell((float(x) + 0.5) / float(n) - 0.5) : 1;
            sum += w * texelFetch(large, clamp(pixel * n + ivec2(x, y), ivec2(0), last), 0);
            weights += w;
        }
    }
    imageStore(small, pixel, max(sum / weights, 0));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "layer_params.h"
#include "../visibility/peel_params.h"

// The fragments of a pixel of the layer over one another: one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D alphas[LS_PEELS];
layout(binding = 1) uniform usampler2D slots;
layout(binding = 2) uniform sampler2D radiance;  // of the fragments
layout(binding = 3, rgba16f) writeonly uniform image2D outColor;
layout(binding = 4, r32f) writeonly uniform image2D outCurve;
layout(push_constant, scalar) uniform Push { LayerParams params; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const uvec4 slot = texelFetch(slots, pixel, 0);
    const vec4 alpha = vec4(texelFetch(alphas[0], pixel, 0).x, texelFetch(alphas[1], pixel, 0).x,
                            texelFetch(alphas[2], pixel, 0).x, texelFetch(alphas[3], pixel, 0).x);
    vec4 sum = vec4(0);  // a: the share that gets the tone curve
    float through = 1;
    for (int i = 0; i < int(LS_PEELS); ++i) {
        if (slot[i] == 0) break;
        const uint at = slot[i] - 1;
        const vec4 own =
            texelFetch(radiance, ivec2(at % LS_LAYER_ROW, at / LS_LAYER_ROW), 0);
        sum += through * alpha[i] * own;
        through *= 1 - alpha[i];
    }
    imageStore(outColor, pixel, vec4(sum.rgb, through));
    imageStore(outCurve, pixel, vec4(sum.a));
}

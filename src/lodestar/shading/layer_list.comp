// SPDX-License-Identifier: Apache-2.0
#version 460
#include "layer_params.h"
#include "../visibility/opaque_depth.glsl"
#include "../visibility/peel_params.h"

// Lists the blended fragments that are to be shaded, one thread a pixel of the layer.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2D ids[LS_PEELS];
layout(binding = 1) uniform sampler2D alphas[LS_PEELS];
layout(binding = 2) uniform sampler2D opaqueDepth;
layout(binding = 3, scalar) buffer Count { uint count; };
layout(binding = 4, r32ui) writeonly uniform uimage2D outIds;
layout(binding = 5, rg32f) writeonly uniform image2D outPoints;
layout(binding = 6, rgba32ui) writeonly uniform uimage2D outSlots;
layout(binding = 7, r32f) writeonly uniform image2D outGuide;
layout(push_constant, scalar) uniform Push { LayerParams params; };

const float kUnseen = 1.0 / 512;  // share of light that is let through

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const vec2 share = (vec2(pixel) + 0.5) / vec2(params.size);
    const uvec4 found = uvec4(texelFetch(ids[0], pixel, 0).x, texelFetch(ids[1], pixel, 0).x,
                              texelFetch(ids[2], pixel, 0).x, texelFetch(ids[3], pixel, 0).x);
    const vec4 alpha = vec4(texelFetch(alphas[0], pixel, 0).x, texelFetch(alphas[1], pixel, 0).x,
                            texelFetch(alphas[2], pixel, 0).x, texelFetch(alphas[3], pixel, 0).x);
    uvec4 slots = uvec4(0);
    float through = 1;
    for (int i = 0; i < int(LS_PEELS); ++i) {
        if (found[i] == 0 || through < kUnseen) break;
        const uint slot = atomicAdd(count, 1);
        slots[i] = slot + 1;
        through *= 1 - alpha[i];
        if (slot < params.capacity) {
            const ivec2 at = ivec2(slot % LS_LAYER_ROW, slot / LS_LAYER_ROW);
            imageStore(outIds, at, uvec4(found[i]));
            imageStore(outPoints, at, vec4(share * 2 - 1, 0, 0));
        }
    }
    imageStore(outSlots, pixel, slots);
    imageStore(outGuide, pixel,
               vec4(opaqueNearness(opaqueDepth, share * vec2(params.fullSize), params.fullSize)));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "temporal_params.h"

// The joined picture, a little sharper, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D joined;
layout(binding = 1, rgba8) writeonly uniform image2D outPicture;
layout(push_constant, scalar) uniform Push { TemporalShowParams params; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    const ivec2 last = ivec2(params.size) - 1;
    if (any(greaterThan(pixel, last))) return;
    const vec3 c = texelFetch(joined, pixel, 0).rgb;
    const vec3 l = texelFetch(joined, max(pixel - ivec2(1, 0), ivec2(0)), 0).rgb;
    const vec3 r = texelFetch(joined, min(pixel + ivec2(1, 0), last), 0).rgb;
    const vec3 u = texelFetch(joined, max(pixel - ivec2(0, 1), ivec2(0)), 0).rgb;
    const vec3 d = texelFetch(joined, min(pixel + ivec2(0, 1), last), 0).rgb;
    // Bounded by the neighbours, so that it draws no halos.
    const vec3 low = min(c, min(min(l, r), min(u, d))), high = max(c, max(max(l, r), max(u, d)));
    const vec3 sharper = c + params.sharpness * (4 * c - l - r - u - d);
    imageStore(outPicture, pixel, vec4(clamp(sharper, low, high), 1));
}

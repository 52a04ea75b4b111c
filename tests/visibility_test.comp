// SPDX-License-Identifier: Apache-2.0
#version 460
#include "lodestar/visibility/triangle.glsl"
#include "lodestar/visibility/view_params.h"

// What triangle.glsl finds at every pixel, as ten numbers: weights, their derivatives, depth.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 6, scalar) uniform View { ViewParams view; };
layout(binding = 7) uniform usampler2D ids;
layout(binding = 8, scalar) writeonly buffer Found { Barycentrics found[]; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    const ivec2 size = textureSize(ids, 0);
    if (any(greaterThanEqual(pixel, size))) return;
    const uint id = texelFetch(ids, pixel, 0).x;
    if (id == 0) return;
    const Triangle t = loadTriangle(id);
    found[pixel.y * size.x + pixel.x] = barycentricsAt(
        view.clipFromWorld * vec4(t.p0, 1), view.clipFromWorld * vec4(t.p1, 1),
        view.clipFromWorld * vec4(t.p2, 1), (vec2(pixel) + 0.5) * 2 / vec2(size) - 1);
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "motion_blur_params.h"
#include "motion_blur_texel.glsl"

// The fastest texel of each tile, or of the tiles around it: one thread a tile.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kAround = 0;  // 1: of 5 × 5 tiles, in `tiles`

layout(binding = 0) uniform usampler2D moving;  // grid B
layout(binding = 1) uniform sampler2D tiles;
layout(binding = 2, rg32f) writeonly uniform image2D outTiles;
layout(push_constant, scalar) uniform Push { MotionBlurParams params; };

void main() {
    const ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(tile, ivec2(params.tiles)))) return;
    const int n = kAround != 0 ? 5 : int(LS_MOTION_TILE);
    const ivec2 first = kAround != 0 ? tile - 2 : tile * n;
    const ivec2 last = ivec2(kAround != 0 ? params.tiles : params.grid.size) - 1;
    vec2 fastest = vec2(0);
    float most = 0;
    for (int i = 0; i < n * n; ++i) {
        const ivec2 at = clamp(first + ivec2(i % n, i / n), ivec2(0), last);
        const vec2 v = kAround != 0 ? texelFetch(tiles, at, 0).xy
                                    : unpackHalf2x16(texelFetch(moving, at, 0).z);
        const float speed = dot(v, v);
        fastest = speed > most ? v : fastest;
        most = max(most, speed);
    }
    imageStore(outTiles, tile, vec4(fastest, 0, 0));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "motion_blur_params.h"
#include "motion_blur_texel.glsl"

// What the pixel of O under the centre of each texel of B shows, one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D color;   // grid O
layout(binding = 1) uniform sampler2D depth;   // grid O
layout(binding = 2) uniform sampler2D motion;  // grid O: see visibility::Motion
layout(binding = 3, rgba32ui) writeonly uniform uimage2D outMoving;
layout(push_constant, scalar) uniform Push { MotionBlurParams params; };

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    const ivec2 at = ivec2(min((vec2(texel) + 0.5) * params.grid.rate,
                               vec2(params.grid.fullSize) - 0.5));
    const vec2 texels = vec2(params.grid.fullSize) / params.grid.rate;
    vec2 velocity = texelFetch(motion, at, 0).xy * texels * (0.5 * params.shutter);
    const float speed = length(velocity);
    velocity *= speed > params.longest ? params.longest / speed : 1;
    const float z = texelFetch(depth, at, 0).x;
    imageStore(outMoving, texel,
               packMoving(Moving(min(texelFetch(color, at, 0).rgb, vec3(6e4)), velocity,
                                 z > 0 ? z : 3e38)));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "temporal_params.h"

// The weighted sum of this frame and the one before (Binks 2011), one thread a pixel of the output.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D now;
layout(binding = 1) uniform sampler2D before;
layout(binding = 2) uniform sampler2D motionNow;
layout(binding = 3) uniform sampler2D motionBefore;
layout(binding = 4, rgba8) writeonly uniform image2D outPicture;
layout(binding = 5) uniform sampler2D layerNow;  // share of blended surfaces
layout(binding = 6) uniform sampler2D layerBefore;
layout(push_constant, scalar) uniform Push { TemporalSourceParams params; };

/// Pixels of the output that what is seen at a place moved.
float speed(sampler2D motion, vec2 at, vec2 live) {
    const vec2 moved = texelFetch(motion, ivec2(clamp(at, vec2(0), live - 1)), 0).xy;
    return length(moved * vec2(params.size));
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, params.size))) return;
    const vec2 share = (vec2(pixel) + 0.5) / vec2(params.size);
    // Each frame is read where it shows this place: moved back by what it was moved.
    const vec2 at = share * params.live + params.jitter;
    const vec2 atBefore = share * params.liveBefore + params.jitterBefore;
    const vec3 color = textureLod(now, clamp(at, vec2(0), params.last) * params.texelSize, 0).rgb;
    const vec3 old =
        textureLod(before, clamp(atBefore, vec2(0), params.lastBefore) * params.texelSize, 0).rgb;
    const float fastest = max(speed(motionNow, at, params.live),
                              speed(motionBefore, atBefore, params.liveBefore));
    // Blended surfaces move otherwise than what is behind them: where they show, or did.
    float ofLayer = 0;
    if (params.layered != 0)
        ofLayer = max(
            texelFetch(layerNow, ivec2(clamp(at, vec2(0), params.live - 1)), 0).x,
            texelFetch(layerBefore, ivec2(clamp(atBefore, vec2(0), params.liveBefore - 1)), 0).x);
    const float weight =
        params.known != 0 ? clamp(1 - params.k * fastest, 0, 1) * (1 - ofLayer) : 0;
    imageStore(outPicture, ivec2(pixel), vec4((color + weight * old) / (1 + weight), 1));
}

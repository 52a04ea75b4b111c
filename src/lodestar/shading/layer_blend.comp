// SPDX-License-Identifier: Apache-2.0
#version 460
#include "layer_params.h"
#include "../visibility/opaque_depth.glsl"

// The layer over the opaque picture, one thread a pixel of grid O. A texel of the layer counts by
// how near it is, and by whether what is opaque behind it is as far away as at the pixel: what it
// shows was cut off by that.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D opaqueDepth;
layout(binding = 1) uniform sampler2D guide;
layout(binding = 2) uniform sampler2D color;  // a: the share of light that is let through
layout(binding = 3) uniform sampler2D curve;
layout(binding = 4, rgba16f) uniform image2D radiance;
layout(binding = 5, r32f) writeonly uniform image2D outCoverage;
layout(push_constant, scalar) uniform Push { LayerParams params; };

const float kSigma = 0.05;  // of nearness, relative
const float kLeast = 1e-3;

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.fullSize)))) return;
    const float own = nearnessOf(texelFetch(opaqueDepth, pixel, 0).x);
    const vec2 at = (vec2(pixel) + 0.5) * vec2(params.size) / vec2(params.fullSize) - 0.5;
    const ivec2 base = ivec2(floor(at)), last = ivec2(params.size) - 1;
    const vec2 f = at - vec2(base);
    vec4 sum = vec4(0), best = vec4(0, 0, 0, 1);
    float curves = 0, weights = 0, bestCurve = 0, least = 1e30;
    for (int i = 0; i < 4; ++i) {
        const ivec2 corner = ivec2(i & 1, i >> 1);
        const ivec2 tap = clamp(base + corner, ivec2(0), last);
        const float there = texelFetch(guide, tap, 0).x;
        const float apart = abs(there - own) / max(max(there, own), 1e-20);
        const vec2 share = mix(1 - f, f, vec2(corner));
        const float tent = share.x * share.y;
        const float unlike = apart / kSigma;
        const float weight = tent * exp2(-unlike * unlike);
        const vec4 texel = texelFetch(color, tap, 0);
        const float texelCurve = texelFetch(curve, tap, 0).x;
        sum += weight * texel;
        curves += weight * texelCurve;
        weights += weight;
        const bool better = apart - 1e-3 * tent < least;  // of equals the nearest in the picture
        least = better ? apart - 1e-3 * tent : least;
        best = better ? texel : best;
        bestCurve = better ? texelCurve : bestCurve;
    }
    const bool enough = weights > kLeast;
    const vec4 layer = enough ? sum / weights : best;
    const float layerCurve = enough ? curves / weights : bestCurve;
    const vec4 behind = imageLoad(radiance, pixel);
    imageStore(radiance, pixel,
               vec4(behind.rgb * layer.a + layer.rgb, behind.a * layer.a + layerCurve));
    imageStore(outCoverage, pixel, vec4(1 - layer.a));
}

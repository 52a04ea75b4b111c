// SPDX-License-Identifier: Apache-2.0
#version 460
#include "spatial_params.h"

// From the live part of a picture to another size, one thread a pixel of the output.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kFilter = LS_FILTER_BILINEAR;

layout(binding = 0) uniform sampler2D source;
layout(binding = 1, rgba8) writeonly uniform image2D outPicture;
layout(push_constant, scalar) uniform Push { SpatialParams params; };

#include "edge_adaptive.glsl"

vec3 nearestAt(vec2 at) {
    return texelFetch(source, ivec2(clamp(at, vec2(0), params.live - 1)), 0).rgb;
}

/// 0 … 1 twice, other values for every pixel and seed (the pcg hash of O'Neill, after Jarzynski &
/// Olano 2020).
vec2 noiseAt(uvec2 pixel) {
    uint h = (pixel.x + pixel.y * 65537u) * 747796405u + params.seed * 2891336453u + 1u;
    h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
    h = (h >> 22u) ^ h;
    return vec2(h & 0xffffu, h >> 16u) / 65535.0;
}

/// The sixteen taps of the cubic B-spline as four bilinear fetches: along an axis taps 0 and 1 with
/// weights w0 and w1 are one fetch at the place that divides them so (Sigg & Hadwiger, GPU Gems 2,
/// ch. 20). A fetch clamped to the live part weighs its last texel twice, as repeating it would.
vec3 bicubicAt(vec2 at) {
    const vec2 base = floor(at - 0.5) + 0.5;
    const vec2 f = at - base, g = 1 - f;
    // An axis of the same size as the output's stays as it is.
    const bvec2 same = equal(params.step, vec2(1));
    const vec2 w0 = mix(g * g * g / 6, vec2(0), same), w3 = mix(f * f * f / 6, vec2(0), same);
    const vec2 w1 = mix(2.0 / 3 - f * f * (1 - 0.5 * f), vec2(1), same);
    const vec2 low = w0 + w1, high = 1 - low;
    const vec2 from = base - 1 + w1 / low, to = base + 1 + w3 / max(high, 1e-6);
    const vec3 top = mix(linearAt(to), linearAt(vec2(from.x, to.y)), low.x);
    const vec3 bottom = mix(linearAt(vec2(to.x, from.y)), linearAt(from), low.x);
    return mix(top, bottom, low.y);
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, params.size))) return;
    const vec2 at = (vec2(pixel) + 0.5) * params.step;
    vec3 color;
    if (kFilter == LS_FILTER_POINT) color = nearestAt(at);
    if (kFilter == LS_FILTER_BILINEAR) color = linearAt(at);
    if (kFilter == LS_FILTER_BICUBIC) color = bicubicAt(at);
    if (kFilter == LS_FILTER_NOISE) color = nearestAt(at) + (noiseAt(pixel).x * 2 - 1) * params.amount;
    if (kFilter == LS_FILTER_NOISE_OFFSET)
        color = linearAt(at + (noiseAt(pixel) * 2 - 1) * params.amount);
    if (kFilter == LS_FILTER_EDGE_ADAPTIVE) color = edgeAdaptiveAt(at);
    imageStore(outPicture, ivec2(pixel), vec4(color, 1));
}

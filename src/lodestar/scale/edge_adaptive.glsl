// SPDX-License-Identifier: Apache-2.0
// Reading a picture between its texels: declare the sampler `source`, and `params` with texelSize
// and last (SpatialParams, TemporalParams) before.
#ifndef LS_EDGE_ADAPTIVE_GLSL
#define LS_EDGE_ADAPTIVE_GLSL

// Of the edge-adaptive filter, chosen by PSNR and FLIP over the scenes of docs/scale.md.
const float kReach = 0.5;      // half the distance of its fetches along an edge [texels]
const float kSteepness = 0.7;  // 0: the ramp of bilinear filtering, 1: the smoothstep
const float kFaintest = 0.1;   // range of the 2×2 texels from which on an edge is one

/// All coordinates are in texels of the source, texel i from i to i + 1.
vec2 inside(vec2 at) { return clamp(at, vec2(0), params.last); }

vec3 linearAt(vec2 at) { return textureLod(source, inside(at) * params.texelSize, 0).rgb; }

/// Bilinear filtering that follows an edge, in one gather and two fetches. The green of the 2×2
/// texels about the place says which way the edge runs and how far across it the place lies:
/// - two fetches a part of a texel apart along the edge smooth its steps, and nothing across it;
/// - both move across it, away from its middle, as far as makes the ramp of bilinear filtering the
///   steeper smoothstep. Every fetch is a mean of texels, so nothing rings.
/// Flat places and chequered ones have no direction and stay bilinear.
vec3 edgeAdaptiveAt(vec2 at) {
    const vec2 place = min(max(at, vec2(0.5)), params.last);
    // Gathered from where the four meet, so that rounding cannot pick others than `f` is of.
    const vec2 base = floor(place - 0.5), f = place - 0.5 - base;
    const vec4 quad = textureGather(source, (base + 1) * params.texelSize, 1);
    const float a = quad.w, b = quad.z, c = quad.x, d = quad.y;  // rows from the top
    const vec2 slope = vec2(mix(b - a, d - c, f.y), mix(c - a, d - b, f.x));
    const float low = min(min(a, b), min(c, d)), high = max(max(a, b), max(c, d));
    const float range = high - low;
    const float steep = dot(slope, slope) + 1e-4;

    const float chequered = abs(a + d - b - c) / (range + 1e-4);
    const float oriented = clamp(2 - chequered, 0, 1);
    const float ramp = (mix(a, b, f.x) + f.y * slope.y - low) / (range + 1e-4);
    const float steeper = ramp * ramp * (3 - 2 * ramp);
    const vec2 across = slope * ((steeper - ramp) * range * kSteepness * oriented / steep);
    const vec2 step = clamp(across, vec2(-0.5), vec2(0.5));
    const vec2 along = vec2(-slope.y, slope.x) * (inversesqrt(steep) * kReach * oriented *
                                                  min(range * (1 / kFaintest), 1));
    return 0.5 * (linearAt(place + step + along) + linearAt(place + step - along));
}

#endif

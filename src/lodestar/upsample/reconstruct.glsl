// SPDX-License-Identifier: Apache-2.0
// Joint bilateral upsampling (Yang, Sander, Lawrence 2008, eq. 1) of one pixel of O. Before it is
// included: the constants kDomain, kRange and kRepair, and the texture `coarse` of grid S.
#ifndef LS_RECONSTRUCT_GLSL
#define LS_RECONSTRUCT_GLSL
#include "coarse_texel.glsl"
#include "reconstruct_params.h"

const int kTaps = kDomain == LS_DOMAIN_NEAREST     ? 1
                  : kDomain == LS_DOMAIN_QUADRATIC ? 3
                  : kDomain == LS_DOMAIN_CUBIC     ? 4
                  : kDomain == LS_DOMAIN_GAUSSIAN  ? 4
                                                   : 2;

/// Weights of the taps along one axis. `f` is where the pixel lies between the taps: for an even
/// number of taps its distance past the middle-left one (0 … 1), for three taps its distance from
/// the middle one (−½ … ½).
void domainWeights(float f, out float w[4]) {
    w = float[4](1, 0, 0, 0);
    if (kDomain == LS_DOMAIN_TENT || kDomain == LS_DOMAIN_NEAREST_DEPTH) {
        w[0] = 1 - f;
        w[1] = f;
    } else if (kDomain == LS_DOMAIN_QUADRATIC) {
        w[0] = 0.5 * (0.5 - f) * (0.5 - f);
        w[1] = 0.75 - f * f;
        w[2] = 0.5 * (0.5 + f) * (0.5 + f);
    } else if (kDomain == LS_DOMAIN_CUBIC) {
        const float g = 1 - f;
        w[0] = g * g * g / 6;
        w[1] = (4 - 6 * f * f + 3 * f * f * f) / 6;
        w[2] = (4 - 6 * g * g + 3 * g * g * g) / 6;
        w[3] = f * f * f / 6;
    } else if (kDomain == LS_DOMAIN_GAUSSIAN) {
        for (int i = 0; i < 4; ++i) {
            const float d = float(i - 1) - f;
            w[i] = exp(-d * d / (2 * 0.7 * 0.7));
        }
        const float sum = w[0] + w[1] + w[2] + w[3];
        for (int i = 0; i < 4; ++i) w[i] /= sum;
    }
}

/// One of the taps alone where any differs in depth by more than 3 σz: the most like one.
vec4 mostLikeInDepth(uvec4 taps[16], float wx[4], float wy[4], float z, float perZ,
                     float depthFalloff) {
    float least = 3e38, most = 0;
    vec4 best = vec4(0), mean = vec4(0);
    for (int j = 0; j < 4; ++j) {
        const float difference = abs(z - coarseDepth(taps[j])) * perZ;
        const vec4 values = coarseTerms(taps[j]);
        if (difference < least) best = values;
        least = min(least, difference);
        most = max(most, difference);
        mean += wx[j % 2] * wy[j / 2] * values;
    }
    // falloff = log2(e) / (2 σ²), so 3 σz = √(4.5 log2(e) / falloff).
    return most * most * depthFalloff <= 4.5 * 1.44269504 ? mean : best;
}

/// How well the taps of a pixel tell its terms.
struct Likeness {
    float least;   // −log2 of the range weight g·g of the tap most like it
    float spread;  // how far the taps that are like it lie apart; with kRepair alone
};

/// The terms of a pixel at depth `z`, 0 being the background, with a view-space normal.
vec4 reconstruct(ivec2 pixel, float z, vec3 normal, ReconstructParams from, out Likeness like) {
    like = Likeness(0, 0);
    // x̂: the pixel's centre in texels of S, texel centres at integers.
    const vec2 at = (vec2(pixel) + 0.5) * from.inverseRate - 0.5;
    const bool odd = (kTaps & 1) == 1;
    const vec2 anchor = floor(odd ? at + 0.5 : at);
    const ivec2 first = ivec2(anchor) - (kTaps - 1) / 2;
    float wx[4], wy[4];
    domainWeights(at.x - anchor.x, wx);
    domainWeights(at.y - anchor.y, wy);

    const vec2 n = foreshortened(normal);
    const float perZ = z > 0 ? 1 / z : 0;
    const ivec2 last = ivec2(from.size) - 1;

    // The range weights are exp2(−e). All e are taken relative to the least, which changes nothing
    // in the quotient but keeps it defined where every tap is unlike the pixel. A tap of (almost) no
    // domain weight does not set that scale, nor gain weight by it: whether rounding makes its
    // weight 0 or 1e-7 must not decide a pixel.
    uvec4 taps[16];
    float e[16];
    float least = 3e38;
    for (int j = 0; j < kTaps * kTaps; ++j) {
        const ivec2 tap = clamp(first + ivec2(j % kTaps, j / kTaps), ivec2(0), last);
        taps[j] = texelFetch(coarse, tap, 0);
        e[j] = 0;
        if (kRange != 0) {
            // Background is like background alone; it has no normal.
            const float tapZ = coarseDepth(taps[j]);
            const float dz = z > 0 ? (z - tapZ) * perZ : tapZ > 0 ? 1 : 0;
            const vec2 dn = z > 0 ? n - coarseNormal(taps[j]) : vec2(0);
            e[j] = min(from.depthFalloff * dz * dz + from.normalFalloff * dot(dn, dn), 1e30);
            if (wx[j % kTaps] * wy[j / kTaps] > 1e-4) least = min(least, e[j]);
        }
    }
    if (kDomain == LS_DOMAIN_NEAREST_DEPTH && kRange != 0)
        return mostLikeInDepth(taps, wx, wy, z, perZ, from.depthFalloff);
    // Where no tap is like the pixel any of them may be wrong; else those that weigh may disagree.
    const float relevant = least > from.unlikeAbove ? 3e38 : least + 2;
    float low = 3e38, high = -3e38;
    vec4 sum = vec4(0);
    float weights = 0;
    for (int j = 0; j < kTaps * kTaps; ++j) {
        const vec4 values = coarseTerms(taps[j]);
        float w = wx[j % kTaps] * wy[j / kTaps];
        if (kRepair != 0) {
            const bool counts = e[j] <= relevant && w >= 0.05;
            const float light = values.x + values.y + values.z;  // each makes a pixel brighter
            low = min(low, counts ? light : 3e38);
            high = max(high, counts ? light : -3e38);
        }
        if (kRange != 0) w *= exp2(clamp(least - e[j], -126.0, 0.0));
        sum += w * values;
        weights += w;
    }
    like = Likeness(least, clamp(high - low, 0, 1));
    return sum / weights;
}

#endif

// SPDX-License-Identifier: Apache-2.0
// Gradient noise and its sum over octaves (Perlin 1985; the quintic fade of Perlin 2002). C++ and
// GLSL.
#ifndef LS_NOISE_H
#define LS_NOISE_H
#include "types.h"

#ifdef __cplusplus
#define LS_FUNCTION inline
namespace lodestar::shared {
using namespace glm;  // the functions below are written in the words both languages share
#else
#define LS_FUNCTION
#endif

/// A hash of a lattice point; integers only, so that all machines agree (after Wang's).
LS_FUNCTION uint noiseHash(ivec3 p) {
    uint h = uint(p.x) * 0x8da6b343u ^ uint(p.y) * 0xd8163841u ^ uint(p.z) * 0xcb1ab31fu;
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return h ^ (h >> 15);
}

/// Gradient of the lattice point times the offset from it. The gradients are 12 edges of the cube,
/// four of them twice, and need no multiplication.
LS_FUNCTION float noiseSlope(ivec3 corner, vec3 offset) {
    const uint h = noiseHash(corner) & 15u;
    const float u = h < 8u ? offset.x : offset.y;
    const float v = h < 4u ? offset.y : (h == 12u || h == 14u ? offset.x : offset.z);
    return ((h & 1u) == 0u ? u : -u) + ((h & 2u) == 0u ? v : -v);
}

/// −1 … 1, 0 at lattice points, twice differentiable.
LS_FUNCTION float perlin(vec3 p) {
    const vec3 cell = floor(p);
    const ivec3 i = ivec3(cell);
    const vec3 f = p - cell;
    const vec3 t = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    float edge[4];
    for (int k = 0; k < 4; ++k) {
        const ivec3 at = ivec3(0, k & 1, k >> 1);
        const float a = noiseSlope(i + at, f - vec3(at));
        const float b = noiseSlope(i + at + ivec3(1, 0, 0), f - vec3(at) - vec3(1, 0, 0));
        edge[k] = mix(a, b, t.x);
    }
    return mix(mix(edge[0], edge[1], t.y), mix(edge[2], edge[3], t.y), t.z);
}

/// The gradient vector whose product with an offset noiseSlope() is.
LS_FUNCTION vec3 noiseGradient(ivec3 corner) {
    return vec3(noiseSlope(corner, vec3(1, 0, 0)), noiseSlope(corner, vec3(0, 1, 0)),
                noiseSlope(corner, vec3(0, 0, 1)));
}

/// perlin() with its derivatives: the gradient in xyz, the value in w.
LS_FUNCTION vec4 perlinSlope(vec3 p) {
    const vec3 cell = floor(p);
    const ivec3 i = ivec3(cell);
    const vec3 f = p - cell;
    const vec3 t = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    const vec3 dt = f * f * (f * (f - 2.0f) + 1.0f) * 30.0f;
    float value = 0.0f;
    vec3 slope = vec3(0.0f);
    for (int k = 0; k < 8; ++k) {
        const ivec3 at = ivec3(k & 1, (k >> 1) & 1, k >> 2);
        const vec3 far = vec3(at);
        // The corner's weight is a product of t or 1 − t an axis.
        const vec3 w = mix(vec3(1.0f) - t, t, far);
        const vec3 dw = dt * (far * 2.0f - vec3(1.0f));
        const vec3 g = noiseGradient(i + at);
        const float v = dot(g, f - far);
        const float weight = w.x * w.y * w.z;
        value += weight * v;
        slope += weight * g + v * vec3(dw.x * w.y * w.z, w.x * dw.y * w.z, w.x * w.y * dw.z);
    }
    return vec4(slope.x, slope.y, slope.z, value);
}

/// Octaves of doubled frequency and half the amplitude, scaled to −1 … 1 at most.
LS_FUNCTION float fractalNoise(vec3 p, int octaves) {
    float sum = 0.0f, amplitude = 1.0f, total = 0.0f;
    for (int i = 0; i < octaves; ++i) {
        // Moved apart, or all octaves would share the zeros of the lattice.
        sum += amplitude * perlin(p + vec3(17.3f, 5.9f, 31.7f) * float(i));
        total += amplitude;
        amplitude *= 0.5f;
        p = p * 2.0f;
    }
    return total > 0.0f ? sum / total : 0.0f;
}

/// The same at points moved by noise themselves, `warps` times over (domain warping): folds of the
/// pattern, for three sums of octaves more a time.
LS_FUNCTION float warpedNoise(vec3 p, int octaves, int warps) {
    vec3 at = p;
    for (int i = 0; i < warps; ++i) {
        const vec3 from = at + vec3(5.2f, 1.3f, 2.8f) * float(i + 1);
        at = p + 0.5f * vec3(fractalNoise(from, octaves),
                             fractalNoise(from + vec3(11.7f, 3.9f, 7.1f), octaves),
                             fractalNoise(from + vec3(23.1f, 19.4f, 13.6f), octaves));
    }
    return fractalNoise(at, octaves);
}

#ifdef __cplusplus
}  // namespace lodestar::shared
#endif
#endif

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

#ifdef __cplusplus
}  // namespace lodestar::shared
#endif
#endif

// SPDX-License-Identifier: Apache-2.0
// Relief finer than a mesh, and how far its triangles are divided for it. C++ and GLSL.
#ifndef LS_DISPLACEMENT_H
#define LS_DISPLACEMENT_H
#include "../shared/noise.h"

#ifdef __cplusplus
#define LS_FUNCTION inline
namespace lodestar::shared {
#else
#define LS_FUNCTION
#endif

const uint LS_TESS_LEVELS = 3u;      // times an edge is halved, at most
const uint LS_TESS_VERTICES = 45u;   // of a triangle divided that often
const uint LS_TESS_TRIANGLES = 64u;  // also threads of a workgroup that makes them
const uint LS_TESS_CAPACITY = 16384u;

/// Times an edge is halved that lies `apart` from the eye at its nearest point: once within
/// `begins`, twice within half of that, and so forth.
LS_FUNCTION uint divisionsAt(float apart, float begins) {
    uint level = 0u;
    for (uint k = 0u; k < LS_TESS_LEVELS; ++k)
        if (apart * float(1u << k) < begins) level = k + 1u;
    return level;
}

/// Share of an octave at a point `apart` from the eye: 0 where the edges there are not yet halved
/// `octave` + 1 times, so that a vertex between two others appears where it already was.
LS_FUNCTION float octaveShare(float apart, float begins, uint octave) {
    const float t = apart * float(1u << octave) / begins;
    return 1.0f - smoothstep(0.5f, 1.0f, t);
}

/// How far a point moves along its normal (w), and the gradient of that (xyz).
LS_FUNCTION vec4 displacementAt(vec3 p, float amplitude, float wavelength, uint octaves,
                                float apart, float begins) {
    vec4 sum = vec4(0.0f);
    float height = 1.0f, total = 0.0f, frequency = 1.0f / wavelength;
    for (uint k = 0u; k < octaves; ++k) {
        // Moved apart, or all octaves would share the zeros of the lattice.
        const vec4 n = perlinSlope(p * frequency + vec3(17.3f, 5.9f, 31.7f) * float(k));
        const float share = height * octaveShare(apart, begins, k);
        sum += share * vec4(n.x * frequency, n.y * frequency, n.z * frequency, n.w);
        total += height;
        height *= 0.5f;
        frequency *= 2.0f;
    }
    return sum * (amplitude / total);
}

#ifdef __cplusplus
}  // namespace lodestar::shared
#endif
#endif

// SPDX-License-Identifier: Apache-2.0
// Unit vectors as two numbers: the octahedral map (Meyer et al. 2010, "On Floating-Point Normal
// Vectors"; survey: Cigolle et al. 2014). C++ and GLSL.
#ifndef LS_OCTAHEDRAL_H
#define LS_OCTAHEDRAL_H
#include "types.h"

#ifdef __cplusplus
#include <glm/packing.hpp>
#define LS_FUNCTION inline
namespace lodestar::shared {
using namespace glm;  // the functions below are written in the words both languages share
#else
#define LS_FUNCTION
#endif

LS_FUNCTION vec2 octahedralWrap(vec2 v) {
    return (vec2(1.0f) - abs(vec2(v.y, v.x))) *
           vec2(v.x >= 0.0f ? 1.0f : -1.0f, v.y >= 0.0f ? 1.0f : -1.0f);
}

/// Unit vector → [−1, 1]². The +z axis lies in the middle.
LS_FUNCTION vec2 octahedralEncode(vec3 n) {
    n /= abs(n.x) + abs(n.y) + abs(n.z);
    return n.z >= 0.0f ? vec2(n.x, n.y) : octahedralWrap(vec2(n.x, n.y));
}

LS_FUNCTION vec3 octahedralDecode(vec2 e) {
    vec3 n = vec3(e.x, e.y, 1.0f - abs(e.x) - abs(e.y));
    const float t = max(-n.z, 0.0f);
    n.x += n.x >= 0.0f ? -t : t;
    n.y += n.y >= 0.0f ? -t : t;
    return normalize(n);
}

/// 2 × 16-bit snorm: 0.003° at worst.
LS_FUNCTION uint packNormal(vec3 n) {
    return packSnorm2x16(octahedralEncode(n));
}
LS_FUNCTION vec3 unpackNormal(uint bits) {
    return octahedralDecode(unpackSnorm2x16(bits));
}

/// The lowest bit holds the sign of the bitangent.
LS_FUNCTION uint packTangent(vec4 t) {
    const uint bits = packSnorm2x16(octahedralEncode(vec3(t.x, t.y, t.z)));
    return (bits & 0xfffffffeu) | (t.w < 0.0f ? 1u : 0u);
}
LS_FUNCTION vec4 unpackTangent(uint bits) {
    return vec4(octahedralDecode(unpackSnorm2x16(bits & 0xfffffffeu)),
                (bits & 1u) != 0u ? -1.0f : 1.0f);
}

#ifdef __cplusplus
}  // namespace lodestar::shared
#endif
#endif

// SPDX-License-Identifier: Apache-2.0
// Vertices on the sample grid: in the same words wherever they are computed, and `precise`, so that
// triangles that share a vertex agree on it.
#ifndef LS_PROJECT_GLSL
#define LS_PROJECT_GLSL
#include "../scene/scene.glsl"
#include "project_params.h"

vec4 clipOf(mat4 clipFromWorld, GpuInstance instance, uint vertex) {
    precise const vec3 world = transformPoint(instance, loadVertex(vertex).position);
    precise const vec4 clip = clipFromWorld * vec4(world, 1);
    return clip;
}

ivec2 snappedTo(vec4 clip, uvec2 size) {
    precise const vec2 at =
        (clip.xy / clip.w * 0.5 + 0.5) * vec2(size) * float(LS_PROJECTED_STEPS);
    return ivec2(floor(at + 0.5));
}

/// Whether a vertex can be snapped: not before the near plane (reversed depth: z > w), and within
/// what the integers hold. Comparisons with NaN fail.
bool inReach(vec4 clip) {
    return clip.z <= clip.w && clip.w > 0 && max(abs(clip.x), abs(clip.y)) <= 2 * clip.w;
}

/// A vertex on the grid, in two words: coordinates of 24 bits, as inReach leaves them, and its flags.
uvec2 packProjected(ivec2 at, uint flags) {
    return uvec2(at << LS_PROJECTED_BITS) | uvec2(flags, 0);
}
ivec2 placeOf(uvec2 vertex) { return ivec2(vertex) >> LS_PROJECTED_BITS; }

/// Which sides of the view volume it is outside of: LS_PROJECTED_OUTSIDE.
uint outside(vec4 clip) {
    return uint(clip.x > clip.w) | uint(clip.x < -clip.w) << 1 | uint(clip.y > clip.w) << 2 |
           uint(clip.y < -clip.w) << 3 | uint(clip.z > clip.w) << 4;
}

#endif

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "triangle.glsl"
#include "motion_params.h"
#include "view_params.h"

// Motion vectors from triangle ids, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const bool kDeforms = false;

layout(binding = 6, scalar) uniform View { ViewParams view; };
layout(binding = 7) uniform usampler2D ids;
layout(binding = 8, rgba32f) writeonly uniform image2D outMotion;
layout(binding = 9) uniform usamplerBuffer previousInstances;
layout(binding = 10) uniform usamplerBuffer previousVertices;  // from firstDeformed on
layout(push_constant, scalar) uniform Push { MotionParams params; };

vec3 previousPoint(uint instance, vec3 p) {
    const int at = int(4 * instance);
    const vec4 h = vec4(p, 1);
    return vec3(dot(uintBitsToFloat(texelFetch(previousInstances, at)), h),
                dot(uintBitsToFloat(texelFetch(previousInstances, at + 1)), h),
                dot(uintBitsToFloat(texelFetch(previousInstances, at + 2)), h));
}

vec3 previousPosition(uint vertex) {
    const vec3 now = loadVertex(vertex).position;
    if (!kDeforms || vertex < params.firstDeformed) return now;
    return uintBitsToFloat(
        texelFetch(previousVertices, int(vertex - params.firstDeformed)).xyz);
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const uint id = texelFetch(ids, pixel, 0).x;
    const vec2 ndc = (vec2(pixel) + 0.5) / vec2(params.size) * 2 - 1;
    const vec2 steady = ndc - view.jitter;

    vec4 before;
    float instance = 0;
    if (id == 0) {
        // The sky is infinitely far: its directions turn with the camera and do not move with it.
        const vec3 ray = transpose(mat3(view.viewFromWorld)) * vec3(steady / view.clipScale, -1);
        before = params.previousClipFromWorld * vec4(ray, 0);
    } else {
        const Triangle t = loadTriangle(id);
        const Barycentrics b =
            barycentricsAt(view.clipFromWorld * vec4(t.p0, 1), view.clipFromWorld * vec4(t.p1, 1),
                           view.clipFromWorld * vec4(t.p2, 1), ndc);
        const uint index = loadCluster(id >> LS_TRIANGLE_BITS).instance;
        const vec3 object = previousPosition(t.vertices.x) * b.at.x +
                            previousPosition(t.vertices.y) * b.at.y +
                            previousPosition(t.vertices.z) * b.at.z;
        before = params.previousClipFromWorld * vec4(previousPoint(index, object), 1);
        instance = 1 + float(index);
    }
    const vec2 moved = before.w > 0 ? (before.xy / before.w - steady) * 0.5 : vec2(4);
    imageStore(outMotion, pixel, vec4(moved, id == 0 ? 0 : before.w, instance));
}

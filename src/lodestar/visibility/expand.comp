// SPDX-License-Identifier: Apache-2.0
#version 460
#include "triangle.glsl"
#include "expand_params.h"
layout(constant_id = 0) const uint kSide = 1;  // s
#define LS_HEADS_BINDING 6
#define LS_LISTS_BINDING 7
#include "record.glsl"

// From the compact record to the id of every pixel of grid O, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

// 0: every pixel of O has its centre on a sample. 1: elsewhere, so edges are tested. 2: O is B, and
// shows the representatives.
layout(constant_id = 1) const uint kMode = 0;

layout(binding = 8, r32ui) writeonly uniform uimage2D outIds;
layout(push_constant, scalar) uniform Push { ExpandParams params; };

const float kReach = 2.5;  // samples: slivers are often seen a little further on

/// The depth of a triangle at a point, 0 where the point is outside it.
float depthAt(uint id, vec2 ndc) {
    const GpuCluster cluster = loadCluster(id >> LS_TRIANGLE_BITS);
    const GpuTriangle stored = loadStoredTriangle(cluster.triangles + (id & LS_TRIANGLE_MASK));
    const GpuInstance instance = loadInstance(cluster.instance);
    const mat4 clip = params.clipFromWorld;
    const Barycentrics b = barycentricsAt(
        clip * vec4(transformPoint(instance, loadVertex(stored.a).position), 1),
        clip * vec4(transformPoint(instance, loadVertex(stored.b).position), 1),
        clip * vec4(transformPoint(instance, loadVertex(stored.c).position), 1), ndc);
    return all(greaterThanEqual(b.at, vec3(0))) ? b.depth : 0;
}

Head headOf(ivec2 pixel) {
    return loadHead(uint(pixel.y) * params.base.x + uint(pixel.x));
}

struct Hit {
    uint id;
    float depth;  // 0: none yet
};

/// Takes a listed id where it is nearer. An alpha-masked triangle is met only where the nearest
/// sample saw it: its edges do not say where its holes are.
void meet(uint id, uint seen, vec2 ndc, inout Hit hit) {
    const bool masked = id >> LS_TRIANGLE_BITS >= params.maskedFrom;
    if (id == 0 || (masked && id != seen)) return;
    const float depth = depthAt(id, ndc);
    if (depth > 0 && (hit.depth == 0 || depth < hit.depth)) hit = Hit(id, depth);
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, params.size))) return;
    if (kMode == 2) {
        imageStore(outIds, ivec2(pixel), uvec4(headOf(ivec2(pixel)).id));
        return;
    }

    const ivec2 gridC = ivec2(params.base * kSide);
    const vec2 point = (vec2(pixel) + 0.5) / vec2(params.size);
    const vec2 samples = point * vec2(gridC);
    const ivec2 cell = min(ivec2(samples), gridC - 1);
    const ivec2 owner = cell / int(kSide), inside = cell % int(kSide);
    const uint sample_ = uint(inside.y) * kSide + uint(inside.x);
    const Head head = headOf(owner);

    const List list = loadList(head);
    const uint listed = listedId(list, shownBy(list, sample_));
    uint seen = head.listed ? listed : head.id;
    if (kMode == 1) {
        // The pixels that own the samples around the point: what covers it is listed there.
        const ivec2 from = clamp(ivec2(floor(samples - kReach)), ivec2(0), gridC - 1) / int(kSide);
        const ivec2 to = clamp(ivec2(floor(samples + kReach)), ivec2(0), gridC - 1) / int(kSide);
        bool mixed = false;
        for (int y = from.y; y <= to.y; ++y)
            for (int x = from.x; x <= to.x; ++x) {
                const Head other = headOf(ivec2(x, y));
                mixed = mixed || other.listed || other.id != head.id;
            }
        Hit hit = Hit(0, 0);
        bool background = false;
        const vec2 ndc = point * 2 - 1;
        for (int y = from.y; mixed && y <= to.y; ++y)
            for (int x = from.x; x <= to.x; ++x) {
                const Head other = headOf(ivec2(x, y));
                background = background || other.id == 0;
                meet(other.id, seen, ndc, hit);
                // No iterations without a list, rather than a branch: see loadList().
                for (uint i = other.list + 1; other.listed; ++i) {
                    const uint word = loadListed(i), id = word & ~LS_LAST_NODE;
                    background = background || id == 0;
                    meet(id, seen, ndc, hit);
                    if (word != id) break;
                }
            }
        // Nothing listed is there: the background if it is listed, else what the sample saw.
        if (hit.depth > 0)
            seen = hit.id;
        else if (mixed && background && seen >> LS_TRIANGLE_BITS < params.maskedFrom)
            seen = 0;
    }
    imageStore(outIds, ivec2(pixel), uvec4(seen));
}

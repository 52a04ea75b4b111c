// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"

// One thread a triangle of the visible clusters: can it cover a pixel centre? The rasteriser would
// drop the others too, but one at a time. No workgroup memory: on a CPU driver its barriers would
// cost more than the test.
layout(local_size_x = LS_CULL_GROUP) in;

layout(binding = 6, scalar) uniform Params { CullParams params; };
layout(binding = 7) uniform usamplerBuffer displaced;
layout(binding = 8) uniform usamplerBuffer refinedMasks;
layout(binding = 9, scalar) readonly buffer Counts { CullCounts counts; };
layout(binding = 10, scalar) buffer Masks { uint masks[]; };  // four words a cluster
layout(binding = 11, scalar) buffer Triangles { uint triangleCounts[]; };
layout(push_constant, scalar) uniform Push { PhaseParams push; };

// Rasterisers snap vertices to a grid of at least 1/16 pixel (commonly 1/256); what is decided here
// must hold wherever the vertices are snapped to.
const float kSnap = 1.0 / 16;

bool canCoverAPixel(vec4 a, vec4 b, vec4 c, bool doubleSided) {
    // Outside one side plane as a whole; true in clip space for any w.
    const vec3 x = vec3(a.x, b.x, c.x), y = vec3(a.y, b.y, c.y), w = vec3(a.w, b.w, c.w);
    if (all(greaterThan(x, w)) || all(lessThan(x, -w)) || all(greaterThan(y, w)) ||
        all(lessThan(y, -w)))
        return false;
    if (any(lessThanEqual(w, vec3(0)))) return true;  // through the eye's plane: let it be clipped

    const vec2 p = (a.xy / a.w * 0.5 + 0.5) * params.size;
    const vec2 q = (b.xy / b.w * 0.5 + 0.5) * params.size;
    const vec2 r = (c.xy / c.w * 0.5 + 0.5) * params.size;
    const vec2 low = min(p, min(q, r)), high = max(p, max(q, r));
    if (any(greaterThan(ceil(low - 0.5 - kSnap), floor(high - 0.5 + kSnap)))) return false;

    // Twice the area in pixels, positive when seen from behind (y runs down).
    const vec2 u = q - p, v = r - p;
    const float area = u.x * v.y - u.y * v.x;
    const float reach = abs(u.x) + abs(u.y) + abs(v.x) + abs(v.y);
    return doubleSided || area < kSnap * (reach + kSnap);
}

/// Whether a refined meshlet stands for a triangle.
bool isReplaced(GpuCluster cluster, GpuInstance instance, uint triangle) {
    if (instance.displaced == 0 || cluster.lod != 0 || params.reliefReach == 0) return false;
    const uvec4 span = texelFetch(displaced, int(2 * instance.displaced + 1));
    const uvec4 mask = texelFetch(refinedMasks, int(span.x + cluster.meshlet - span.y));
    return (mask[triangle / 32] & (1u << (triangle & 31))) != 0;
}

void main() {
    const uint slot = linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_CULL_GROUP,
                                   gl_LocalInvocationID.x);
    const uint which = slot / LS_CLUSTER_SLOTS, t = slot % LS_CLUSTER_SLOTS;
    const bool second = push.phase == 1;
    if (which >= counts.lists[second ? LS_LIST_CLUSTERS_2 : LS_LIST_CLUSTERS].count) return;
    const GpuCluster cluster =
        loadCluster(push.table + which + (second ? counts.lists[LS_LIST_CLUSTERS].count : 0));
    const bool doubleSided = (cluster.bin & 1) != 0;  // of scene::DrawBin
    // A loop of one round: a CPU driver runs both sides of a branch, but leaves a loop that no lane
    // is in. Half of the slots are empty.
    for (uint i = t; i < cluster.triangleCount; i += LS_CLUSTER_SLOTS) {
        const GpuInstance instance = loadInstance(cluster.instance);
        bool drawn = params.mode == LS_CULL_NONE;
        if (!drawn) {
            const bool reflected = (instance.flags & LS_INSTANCE_REFLECTED) != 0;
            const GpuTriangle triangle = loadStoredTriangle(cluster.triangles + i);
            const vec4 a = params.clipFromWorld *
                           vec4(transformPoint(instance, loadVertex(triangle.a).position), 1);
            const vec4 b = params.clipFromWorld *
                           vec4(transformPoint(instance, loadVertex(triangle.b).position), 1);
            const vec4 c = params.clipFromWorld *
                           vec4(transformPoint(instance, loadVertex(triangle.c).position), 1);
            drawn = canCoverAPixel(a, reflected ? c : b, reflected ? b : c, doubleSided);
        }
        if (drawn && !isReplaced(cluster, instance, i)) {
            atomicOr(masks[4 * which + i / 32], 1u << (i & 31));
            atomicAdd(triangleCounts[which], 1);
        }
    }
}

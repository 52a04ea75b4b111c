// SPDX-License-Identifier: Apache-2.0
#version 460
#include "cull_params.h"
#include "project.glsl"

// One thread 32 triangles of a visible cluster: which of them can cover a pixel centre? The rasteriser
// would drop the others too, but one at a time. What the triangles share is fetched once.
layout(local_size_x = LS_SPAN) in;
layout(constant_id = 0) const uint kProjected = 0;  // whether vertices have been: project.comp

layout(binding = 6, scalar) uniform Params { CullParams params; };
layout(binding = 7) uniform usamplerBuffer displaced;
layout(binding = 8) uniform usamplerBuffer refinedMasks;
layout(binding = 9, scalar) readonly buffer Counts { CullCounts counts; };
layout(binding = 10, scalar) buffer Masks { uint masks[]; };  // four words a cluster
layout(binding = 11, scalar) buffer Triangles { uint triangleCounts[]; };
layout(binding = 12) uniform usamplerBuffer projected;
layout(push_constant, scalar) uniform Push { ProjectParams push; };

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

/// The same of projected vertices, in the samples that will be asked.
bool canCoverASample(uvec2 a, uvec2 b, uvec2 c) {
    const uint flags = a.x | b.x | c.x;
    if ((a.x & b.x & c.x & LS_PROJECTED_OUTSIDE) != 0) return false;
    if ((flags & LS_PROJECTED_CLIP) != 0) return true;
    const ivec2 p = placeOf(a), q = placeOf(b), r = placeOf(c);
    const ivec2 low = min(p, min(q, r)), high = max(p, max(q, r));
    const int middle = int(LS_PROJECTED_STEPS / 2);
    const ivec2 first = max((low + (middle - 1)) >> 8, ivec2(0, push.firstRow));
    const ivec2 last = min((high - middle) >> 8, ivec2(push.size.x, push.firstRow + push.rows) - 1);
    if (any(greaterThan(first, last))) return false;
    // Twice the area, positive when seen from behind (y runs down).
    const vec2 u = vec2(q - p), v = vec2(r - p);
    const float one = u.x * v.y, other = u.y * v.x;
    const float area = (flags & LS_PROJECTED_REFLECTED) != 0 ? other - one : one - other;
    const float rounding = (abs(one) + abs(other)) * 1e-6;
    return area < rounding || (flags & LS_PROJECTED_DOUBLE_SIDED) != 0;
}

/// Those of the cluster's triangles in a word that refined meshlets stand for.
uint replaced(GpuCluster cluster, GpuInstance instance, uint word) {
    const uint relief = params.reliefReach == 0 ? 0 : instance.displaced;
    if (relief == 0 || cluster.lod != 0) return 0;
    const uvec4 span = texelFetch(displaced, int(2 * relief + 1));
    return texelFetch(refinedMasks, int(span.x + cluster.meshlet - span.y))[word];
}

void main() {
    uvec2 item = clusterAndWord(gl_WorkGroupID, gl_NumWorkGroups, gl_LocalInvocationID.x);
    const bool second = push.phase == 1;
    const uint before = second ? counts.lists[LS_LIST_CLUSTERS].count : 0;
    if (kProjected == 0) item.x += push.capacity - min(before, push.capacity);
    const uint slot = before + item.x;
    if (item.x >= counts.lists[second ? LS_LIST_CLUSTERS_2 : LS_LIST_CLUSTERS].count ||
        (kProjected != 0 && slot >= push.capacity))
        return;
    const GpuCluster cluster = loadCluster(push.table + slot);
    const GpuInstance instance = loadInstance(cluster.instance);
    const mat4 clipFromObject =
        params.clipFromWorld *
        transpose(mat4(instance.row0, instance.row1, instance.row2, vec4(0, 0, 0, 1)));
    const bool doubleSided = (cluster.bin & 1) != 0;  // of scene::DrawBin
    const bool reflected = (instance.flags & LS_INSTANCE_REFLECTED) != 0;
    const uint first = 32 * item.y, end = min(first + 32, cluster.triangleCount);
    const int place = int(slot * LS_MESHLET_VERTICES);
    // Not a branch on a uniform alone: docs/gpu.md.
    const uint firstTested = params.mode == LS_CULL_NONE ? end : first;
    uint mask = 0;
    for (uint i = first; i < end; ++i) {
        const GpuTriangle t = loadStoredTriangle(cluster.triangles + i);
        bool drawn = i < firstTested;
        if (kProjected != 0) {
            const ivec3 own = place + ivec3(uvec3(t.own, t.own >> 8, t.own >> 16) & 255u);
            drawn = drawn || canCoverASample(texelFetch(projected, own.x).xy,
                                             texelFetch(projected, own.y).xy,
                                             texelFetch(projected, own.z).xy);
        } else {
            const vec4 a = clipFromObject * vec4(loadVertex(t.a).position, 1);
            const vec4 b = clipFromObject * vec4(loadVertex(t.b).position, 1);
            const vec4 c = clipFromObject * vec4(loadVertex(t.c).position, 1);
            drawn = drawn || canCoverAPixel(a, reflected ? c : b, reflected ? b : c, doubleSided);
        }
        mask |= uint(drawn) << (i - first);
    }
    if (mask != 0) mask &= ~replaced(cluster, instance, item.y);
    masks[LS_WORDS * item.x + item.y] = mask;
    if (mask != 0) atomicAdd(triangleCounts[item.x], uint(bitCount(mask)));
}

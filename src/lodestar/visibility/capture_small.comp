// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute.glsl"

// One thread a listed triangle: rasterises the small ones, queues the others.

layout(constant_id = 3) const int kSmall = 256;  // samples of the box of a small triangle, at most
layout(constant_id = 4) const uint kProjected = 1;  // those whose vertices are, or the others

void main() {
    const uint index = gl_GlobalInvocationID.x +
                       gl_GlobalInvocationID.y * gl_NumWorkGroups.x * LS_CAPTURE_GROUP;
    const uint begin = kProjected != 0 ? 0 : counts.projected;
    const uint count = (kProjected != 0 ? counts.projected : counts.count) - begin;
    const bool listed = index < count;
    const uint id =
        texelFetch(listedIds, int(counts.first + begin + min(index, count - 1))).x;
    const uint cluster = id >> LS_TRIANGLE_BITS, slot = cluster - params.table;
    const uvec4 what = texelFetch(sceneClusters, int(2 * cluster));  // a GpuCluster
    const GpuTriangle stored = loadStoredTriangle(what.z + (id & LS_TRIANGLE_MASK));

    Corners t;
    t.id = id;
    bool clip, fromBehind;
    uint beyond;  // sides that all three corners are outside of
    if (kProjected != 0) {
        const ivec3 own = int((listed ? slot : 0) * LS_MESHLET_VERTICES) +
                          ivec3(uvec3(stored.own, stored.own >> 8, stored.own >> 16) & 255u);
        const uvec2 a = texelFetch(projected, own.x).xy, b = texelFetch(projected, own.y).xy,
                    c = texelFetch(projected, own.z).xy;
        t.v0 = placeOf(a);
        t.v1 = placeOf(b);
        t.v2 = placeOf(c);
        t.depth = vec3(texelFetch(projectedDepths, own.x).x, texelFetch(projectedDepths, own.y).x,
                       texelFetch(projectedDepths, own.z).x);
        if ((a.x & LS_PROJECTED_REFLECTED) != 0)
            t = Corners(t.v0, t.v2, t.v1, t.depth.xzy, t.id);
        clip = ((a.x | b.x | c.x) & LS_PROJECTED_CLIP) != 0;
        beyond = a.x & b.x & c.x & LS_PROJECTED_OUTSIDE;
        fromBehind = (a.x & LS_PROJECTED_DOUBLE_SIDED) != 0;
    } else {
        const GpuInstance instance = loadInstance(what.x);
        const bool reflected = (instance.flags & LS_INSTANCE_REFLECTED) != 0;
        const vec4 a = clipOf(params.clipFromWorld, instance, stored.a);
        const vec4 b = clipOf(params.clipFromWorld, instance, reflected ? stored.c : stored.b);
        const vec4 c = clipOf(params.clipFromWorld, instance, reflected ? stored.b : stored.c);
        clip = !(inReach(a) && inReach(b) && inReach(c));
        beyond = outside(a) & outside(b) & outside(c);
        t.v0 = clip ? ivec2(0) : snappedTo(a, params.size);
        t.v1 = clip ? ivec2(0) : snappedTo(b, params.size);
        t.v2 = clip ? ivec2(0) : snappedTo(c, params.size);
        t.depth = vec3(a.z / a.w, b.z / b.w, c.z / c.w);
        fromBehind = doubleSided(id);
    }
    if (listed && clip && beyond == 0) {
        const uint place = atomicAdd(counts.clipped, 1);
        if (place < LS_CAPTURE_CLIPPED) clipped[place] = id;
        if (place % LS_CAPTURE_GROUP == 0)
            atomicMax(counts.clipGroups[0],
                      min(place / LS_CAPTURE_GROUP + 1, LS_CAPTURE_MOST_GROUPS));
    }

    const bool front = makeFront(t, fromBehind) && listed && !clip;
    const ivec4 box = boxOf(t.v0, t.v1, t.v2);
    const ivec2 size = box.zw - box.xy + 1;
    const bool seen = front && min(size.x, size.y) > 0;
    const bool small = max(size.x, size.y) <= 64 && size.x * size.y <= kSmall;
    const bool here = seen && small;
    const Setup s = makeSetup(t);
    bool room = true;
    if (seen && !small) room = queueLarge(s);
    if (here) loadMasked(id);
    rasterise(s, box.xy, here ? box.zw : box.xy - 1, 1);
    // Where the queue is full: slowly, but all of it.
    if (!room) {
        loadMasked(id);
        rasteriseAll(s, seen && !small);
    }
}

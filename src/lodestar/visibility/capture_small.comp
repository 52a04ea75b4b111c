// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute.glsl"

// One thread a listed triangle: rasterises the small ones, queues the others.

layout(constant_id = 3) const int kSmall = 256;  // samples of the box of a small triangle, at most

void main() {
    const uint index = gl_GlobalInvocationID.x +
                       gl_GlobalInvocationID.y * gl_NumWorkGroups.x * LS_CAPTURE_GROUP;
    const bool listed = index < counts.count;
    const uint id = texelFetch(listedIds, int(counts.first + (listed ? index : 0))).x;
    const GpuCluster cluster = loadCluster(id >> LS_TRIANGLE_BITS);
    const GpuInstance instance = loadInstance(cluster.instance);
    const GpuTriangle stored = loadStoredTriangle(cluster.triangles + (id & LS_TRIANGLE_MASK));
    const bool reflected = (instance.flags & LS_INSTANCE_REFLECTED) != 0;
    const uvec3 corners = uvec3(stored.a, reflected ? stored.c : stored.b,
                                reflected ? stored.b : stored.c);
    precise const vec4 a = params.clipFromWorld *
                           vec4(transformPoint(instance, loadVertex(corners.x).position), 1);
    precise const vec4 b = params.clipFromWorld *
                           vec4(transformPoint(instance, loadVertex(corners.y).position), 1);
    precise const vec4 c = params.clipFromWorld *
                           vec4(transformPoint(instance, loadVertex(corners.z).position), 1);

    const bool clip = mustClip(a, b, c);
    if (listed && clip) {
        const uint slot = atomicAdd(counts.clipped, 1);
        if (slot < LS_CAPTURE_CLIPPED) clipped[slot] = id;
    }

    const bool usable = listed && !clip;
    CaptureLarge t = CaptureLarge(ivec2(0), ivec2(0), ivec2(0), vec3(0), id);
    if (usable)
        t = CaptureLarge(snapped(a), snapped(b), snapped(c), vec3(a.z / a.w, b.z / b.w, c.z / c.w),
                         id);
    const bool front = makeFront(t) && usable;
    const ivec4 box = boxOf(t);
    const ivec2 size = box.zw - box.xy + 1;
    const bool seen = front && min(size.x, size.y) > 0;
    const bool small = max(size.x, size.y) <= kTile && size.x * size.y <= kSmall;
    bool here = seen && small;
    bool room = true;
    if (seen && !small) room = queueLarge(t);
    if (here) loadMasked(id);
    rasterise(makeSetup(t), box.xy, here ? box.zw : box.xy - 1, 1);
    // Where the queue is full: slowly, but all of it.
    if (!room) {
        loadMasked(id);
        rasteriseAll(t, seen && !small);
    }
}

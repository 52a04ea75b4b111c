// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute.glsl"

// One thread a triangle that crosses the near plane or reaches far beyond the picture: clips it,
// and queues what remains as large triangles. Where there were more of them than places, it looks at
// all that are listed.

const int kMost = 9;  // corners after clipping by five planes, and one spare
vec4 polygon[kMost], next[kMost];
int corners;

float inside(vec4 v, int plane) {
    if (plane == 0) return v.w - v.z;  // near
    const float reach = 2 * v.w;
    return plane == 1 ? reach - v.x : plane == 2 ? reach + v.x : plane == 3 ? reach - v.y : reach + v.y;
}

/// Where an edge crosses, always from its inner end: two triangles that share the edge then agree.
vec4 crossing(vec4 from, vec4 to, float fromInside, float toInside) {
    precise const vec4 at = from + (to - from) * (fromInside / (fromInside - toInside));
    return at;
}

void clipBy(int plane) {
    int count = 0;
    for (int i = 0; i < corners; ++i) {
        const vec4 a = polygon[i], b = polygon[i + 1 < corners ? i + 1 : 0];
        const float ia = inside(a, plane), ib = inside(b, plane);
        if (ia >= 0) next[count++] = a;
        if ((ia >= 0) != (ib >= 0))
            next[count++] = ia >= 0 ? crossing(a, b, ia, ib) : crossing(b, a, ib, ia);
    }
    corners = count;
    for (int i = 0; i < count; ++i) polygon[i] = next[i];
}

void main() {
    const bool missing = counts.clipped > LS_CAPTURE_CLIPPED;
    const uint count = missing ? counts.count : counts.clipped;
    for (uint at = gl_GlobalInvocationID.x; at < count; at += LS_CAPTURE_GROUP * LS_CAPTURE_LOOPS) {
        const uint id = missing ? texelFetch(listedIds, int(counts.first + at)).x : clipped[at];
        const GpuCluster cluster = loadCluster(id >> LS_TRIANGLE_BITS);
        const GpuInstance instance = loadInstance(cluster.instance);
        for (uint i = 0; i < 3; ++i) {
            const uint vertex = cornerVertex(cluster, instance, id, i);
            precise const vec4 p = params.clipFromWorld *
                                   vec4(transformPoint(instance, loadVertex(vertex).position), 1);
            polygon[i] = p;
        }
        corners = mustClip(polygon[0], polygon[1], polygon[2]) ? 3 : 0;
        for (int plane = 0; plane < 5; ++plane) clipBy(plane);
        for (int i = 1; i + 1 < corners; ++i) {
            const vec4 a = polygon[0], b = polygon[i], c = polygon[i + 1];
            CaptureLarge t = CaptureLarge(snapped(a), snapped(b), snapped(c),
                                          vec3(a.z / a.w, b.z / b.w, c.z / c.w), id);
            const bool front = makeFront(t);
            const ivec4 box = boxOf(t);
            if (!front || any(greaterThan(box.xy, box.zw))) continue;
            if (!queueLarge(t)) {
                loadMasked(id);
                rasteriseAll(t, true);
            }
        }
    }
}

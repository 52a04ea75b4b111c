// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute.glsl"

// One thread a large triangle: queues the tiles of grid C that it can touch.

void main() {
    const uint count = min(counts.large, LS_CAPTURE_LARGE);
    for (uint at = gl_GlobalInvocationID.x; at < count; at += LS_CAPTURE_GROUP * LS_CAPTURE_LOOPS) {
        const CaptureLarge t = large[at];
        const ivec4 box = boxOf(t);
        const ivec2 first = box.xy / kTile, last = box.zw / kTile;
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x) {
                const ivec2 from = tileFirst(ivec2(x, y), box), to = tileLast(ivec2(x, y), box);
                if (outside(t, from, to)) continue;
                const uint slot = atomicAdd(counts.jobs, 1);
                if (slot < LS_CAPTURE_JOBS) {
                    jobs[slot] = uvec2(at, uint(x) | uint(y) << 16);
                } else {
                    loadMasked(t.id);
                    rasterise(makeSetup(t), from, to, 1);
                }
            }
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute.glsl"

// One workgroup a tile of a large triangle, one thread a column.

void main() {
    const uint count = min(counts.jobs, LS_CAPTURE_JOBS);
    for (uint job = gl_WorkGroupID.x; job < count; job += LS_CAPTURE_LOOPS) {
        const uvec2 what = jobs[job];
        const CaptureLarge t = large[what.x];
        const ivec2 tile = ivec2(what.y & 0xffffu, what.y >> 16);
        const ivec4 box = boxOf(t);
        const ivec2 first = tileFirst(tile, box), last = tileLast(tile, box);
        const ivec2 own = ivec2(tile.x * kTile + int(gl_LocalInvocationID.x), first.y);
        loadMasked(t.id);
        rasterise(makeSetup(t), own, own.x >= first.x ? last : own - 1, kTile);
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute.glsl"

// A few threads a large triangle: hang it into the lists of the tiles of grid C that it can touch.

void main() {
    const uint count = min(counts.large, LS_CAPTURE_LARGE);
    const uint each = LS_CAPTURE_GROUP / LS_CAPTURE_SPLITTERS;
    const int across = (int(params.size.x) + kTile.x - 1) / kTile.x;
    const int firstTile = int(params.firstRow) / kTile.y;
    for (uint at = gl_GlobalInvocationID.x / LS_CAPTURE_SPLITTERS; at < count;
         at += each * gl_NumWorkGroups.x) {
        const Setup s = loadLarge(at);
        const ivec4 box = boxOf(s.v0, s.v1, s.v2);
        const ivec2 first = box.xy / kTile, tiles = box.zw / kTile - first + 1;
        for (int i = int(gl_LocalInvocationID.x % LS_CAPTURE_SPLITTERS); i < tiles.x * tiles.y;
             i += int(LS_CAPTURE_SPLITTERS)) {
            const ivec2 tile = first + ivec2(i % tiles.x, i / tiles.x);
            const ivec2 from = tileFirst(tile, box), to = tileLast(tile, box);
            if (outside(s, from, to)) continue;
            const uint job = atomicAdd(counts.jobs, 1);
            if (job < LS_CAPTURE_JOBS) {
                const uint index = uint((tile.y - firstTile) * across + tile.x);
                const uint next = atomicExchange(heads[index], job + 1);
                jobs[job] = uvec2(at, next);
                if (next == 0) {
                    const uint place = atomicAdd(counts.tiles, 1);
                    touched[place] = index;
                    atomicMax(counts.tileGroups[0], min(place + 1, LS_CAPTURE_MOST_GROUPS));
                }
            } else {
                loadMasked(s.id);
                rasterise(s, from, to, 1);
            }
        }
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_compute.glsl"

// One workgroup a tile that large triangles touch, a thread for eight samples of a column: they stay
// in registers while it goes through the tile's triangles, so that none of these needs an atomic.

const int kRows = 8;  // of a thread

/// The nearest of four samples below one another so far: depth bits and ids.
struct Nearest {
    uvec4 depth, id;
};

void test(inout Nearest nearest, Setup s, ivec2 first, ivec3 e, ivec3 stepY) {
    const ivec4 row = ivec4(0, 1, 2, 3);
    const ivec4 inside = (e.x + stepY.x * row) | (e.y + stepY.y * row) | (e.z + stepY.z * row);
    const float toX = float(first.x * kSub + kSub / 2 - s.v0.x);
    const vec4 toY = vec4((first.y + row) * kSub + kSub / 2 - s.v0.y);
    precise const vec4 plane = s.depth + s.depthX * toX + s.depthY * toY;
    const uvec4 depth = floatBitsToUint(clamp(plane, vec4(s.least), vec4(s.most)));
    for (int i = 0; i < 4; ++i) {
        const bool nearer = depth[i] > nearest.depth[i] ||
                            (depth[i] == nearest.depth[i] && s.id > nearest.id[i]);
        if (inside[i] >= 0 && nearer) {
            nearest.depth[i] = depth[i];
            nearest.id[i] = s.id;
        }
    }
}

/// Nothing else writes to the tile meanwhile.
void write(Nearest nearest, ivec2 first) {
    for (int i = 0; i < 4; ++i) {
        const ivec2 at = first + ivec2(0, i);
        const int row = at.y - int(params.firstRow);
        if (nearest.id[i] == 0 || at.x >= int(params.size.x) || row < 0 || row >= int(params.rows))
            continue;
        const int index = row * int(params.size.x) + at.x;
        const uvec2 old = texelFetch(wordTexels, index).xy;
        if (nearest.depth[i] > old.y || (nearest.depth[i] == old.y && nearest.id[i] > old.x))
            words[index] = packUint2x32(uvec2(nearest.id[i], nearest.depth[i]));
    }
}

void main() {
    const int across = (int(params.size.x) + kTile.x - 1) / kTile.x;
    const ivec2 own = ivec2(int(gl_LocalInvocationID.x) % kTile.x,
                            int(gl_LocalInvocationID.x) / kTile.x * kRows);
    for (uint at = gl_WorkGroupID.x; at < counts.tiles; at += gl_NumWorkGroups.x) {
        const int tile = int(touched[at]);
        const ivec2 first =
            ivec2(tile % across, int(params.firstRow) / kTile.y + tile / across) * kTile + own;
        Nearest upper = Nearest(uvec4(0), uvec4(0)), lower = upper;
        uint next = heads[tile];
        while (next != 0) {
            const uvec2 job = texelFetch(jobTexels, int(next - 1)).xy;
            next = job.y;
            const Setup s = loadLarge(job.x);
            if (kMasked != 0) {
                const ivec4 box = boxOf(s.v0, s.v1, s.v2);
                const ivec2 from = ivec2(first.x, max(first.y, box.y));
                const ivec2 to = ivec2(first.x, min(first.y + kRows - 1, box.w));
                loadMasked(s.id);
                rasterise(s, from, first.x >= box.x && first.x <= box.z ? to : from - 1, kTile.x);
                continue;
            }
            const ivec3 e = ivec3(edgeAt(s.v0, s.v1, first), edgeAt(s.v1, s.v2, first),
                                  edgeAt(s.v2, s.v0, first));
            const ivec3 stepY = ivec3(s.v1.x - s.v0.x, s.v2.x - s.v1.x, s.v0.x - s.v2.x);
            test(upper, s, first, e, stepY);
            test(lower, s, first + ivec2(0, 4), e + 4 * stepY, stepY);
        }
        if (kMasked != 0) continue;
        write(upper, first);
        write(lower, first + ivec2(0, 4));
    }
}

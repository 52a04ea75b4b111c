// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/tiles.glsl"
#include "list_tiles_params.h"

// One thread a tile: does any of its pixels show a triangle?
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2D ids;
layout(binding = 1, scalar) buffer CoveredGroups { uint coveredGroups[3]; };
layout(binding = 2, scalar) buffer Covered { uint covered[]; };
layout(binding = 3, scalar) buffer EmptyGroups { uint emptyGroups[3]; };
layout(binding = 4, scalar) buffer Empty { uint empty[]; };
layout(push_constant, scalar) uniform Push { ListTilesParams params; };

void main() {
    const uvec2 tile = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(8 * tile, params.size))) return;
    // Four pixels a fetch, about the corner where they meet.
    const ivec2 last = ivec2(params.size) - 1;
    const vec2 perPixel = 1 / vec2(textureSize(ids, 0));
    uvec4 four = uvec4(0);
    for (int i = 0; i < 16; ++i) {
        const ivec2 corner = min(8 * ivec2(tile) + 2 * ivec2(i & 3, i >> 2) + 1, last);
        four |= textureGather(ids, vec2(corner) * perPixel);
    }
    const uint found = four.x | four.y | four.z | four.w;

    const uint place = tile.x | tile.y << 16;
    if (found != 0) {
        const uint item = atomicAdd(covered[0], 1);
        covered[1 + item] = place;
        if (item % LS_TILE_ROW == 0) atomicMax(coveredGroups[1], item / LS_TILE_ROW + 1);
        if (item == 0) coveredGroups[0] = LS_TILE_ROW;
        if (item == 0) coveredGroups[2] = 1;
    } else {
        const uint item = atomicAdd(empty[0], 1);
        empty[1 + item] = place;
        if (item % LS_TILE_ROW == 0) atomicMax(emptyGroups[1], item / LS_TILE_ROW + 1);
        if (item == 0) emptyGroups[0] = LS_TILE_ROW;
        if (item == 0) emptyGroups[2] = 1;
    }
}

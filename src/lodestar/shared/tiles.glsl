// SPDX-License-Identifier: Apache-2.0
// The pixel of a thread in an 8×8 workgroup that works on listed tiles: Recorder::dispatchTiles.
#ifndef LS_TILES_GLSL
#define LS_TILES_GLSL

const uint LS_ALL_TILES = 0xffffffffu;  // in place of the number of tiles: the grid is not listed
const uint LS_TILE_ROW = 128;           // workgroups along x of a dispatch over a list

ivec2 pixelOfThread(usamplerBuffer tiles) {
    const uint count = texelFetch(tiles, 0).x;
    if (count == LS_ALL_TILES) return ivec2(gl_GlobalInvocationID.xy);
    const uint item = gl_WorkGroupID.y * LS_TILE_ROW + gl_WorkGroupID.x;
    if (item >= count) return ivec2(0x7fffffff);  // outside any grid
    const uint tile = texelFetch(tiles, int(1 + item)).x;
    return 8 * ivec2(tile & 0xffffu, tile >> 16) + ivec2(gl_LocalInvocationID.xy);
}

#endif

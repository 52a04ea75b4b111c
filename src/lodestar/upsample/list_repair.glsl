// SPDX-License-Identifier: Apache-2.0
// Pixels to repair. Before it is included: `repair`, a RepairHeader, and `listed`, the list.
#ifndef LS_LIST_REPAIR_GLSL
#define LS_LIST_REPAIR_GLSL
#include "reconstruct.glsl"

const float kNoRepair = -1;
const float kQuiteUnlike = 12;  // times the unlikeness from which on taps are unlike a pixel

/// How much a pixel wants to be evaluated anew, 0 … 1, or kNoRepair. First come those that no tap
/// is like, which may hold anything: more so the further the taps lie apart, and a little the less
/// like it they are. Then those whose taps are like it and disagree.
float repairRank(Likeness like, ReconstructParams from) {
    if (like.least > from.unlikeAbove)
        return 0.5 + 0.4 * like.spread +
               0.1 * min(like.least / (kQuiteUnlike * from.unlikeAbove), 1);
    return like.spread > from.spreadAbove ? 0.5 * like.spread : kNoRepair;
}

/// Adds a pixel that wants it to the list, of the higher bins the higher its rank.
void listForRepair(ivec2 pixel, uvec2 size, Likeness like, ReconstructParams from) {
    const float rank = repairRank(like, from);
    if (rank < 0) return;
    const uint bin = uint(clamp(rank * float(LS_REPAIR_BINS), 0, float(LS_REPAIR_BINS) - 1));
    const uint index = pixel.y * size.x + pixel.x;
    listed[atomicAdd(repair.listed, 1)] = index | bin << LS_REPAIR_INDEX_BITS;
}

#endif

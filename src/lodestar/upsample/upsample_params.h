// SPDX-License-Identifier: Apache-2.0
#ifndef LS_UPSAMPLE_PARAMS_H
#define LS_UPSAMPLE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_DOMAIN_NEAREST = 0u;
const uint LS_DOMAIN_TENT = 1u;           // 2×2
const uint LS_DOMAIN_QUADRATIC = 2u;      // 3×3, quadratic B-spline
const uint LS_DOMAIN_CUBIC = 3u;          // 4×4, cubic B-spline
const uint LS_DOMAIN_GAUSSIAN = 4u;       // 4×4, σ = 0.7 texels of S
const uint LS_DOMAIN_NEAREST_DEPTH = 5u;  // of the 2×2 the one most like in depth, or their tent

const uint LS_REPAIR_BINS = 64u;
const uint LS_REPAIR_INDEX_BITS = 26u;  // of a listed pixel: its index, and above it the bin

struct UpsampleParams {
    uvec2 size;           // of S
    uvec2 fullSize;       // of O
    float inverseRate;    // 1/r
    float depthFalloff;   // log2(e) / (2 σz²); 0 for σz = ∞
    float normalFalloff;  // log2(e) / (2 σn²); 0 for σn = ∞
    uint terms;           // channels of the output to write, a bit each
    float repairAbove;    // −log2 of the least g·g of the best tap that need no repair
    float repairSpread;   // nor taps that lie no further apart than this
};

/// Pixels whose taps are all unlike them or disagree, those that want it more in higher bins.
struct RepairHeader {
    uint groups[3];  // of 64 threads, for the pixels kept
    uint listed;
    uint kept;
    uint cut;     // bins from here on are kept
    uint partOf;  // and of the one below as large a share as this is of 2³²
    uint bins[LS_REPAIR_BINS];
};

struct RepairSelectParams {
    uint most;  // pixels that may be kept
};

LS_NAMESPACE_END
#endif

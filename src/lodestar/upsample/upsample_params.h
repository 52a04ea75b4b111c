// SPDX-License-Identifier: Apache-2.0
#ifndef LS_UPSAMPLE_PARAMS_H
#define LS_UPSAMPLE_PARAMS_H
#include "../shared/types.h"
#include "reconstruct_params.h"
LS_NAMESPACE_BEGIN

const uint LS_REPAIR_BINS = 64u;
const uint LS_REPAIR_INDEX_BITS = 26u;  // of a listed pixel: its index, and above it the bin

struct UpsampleParams {
    ReconstructParams from;
    uvec2 fullSize;  // of O
    uint terms;      // channels of the output to write, a bit each
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

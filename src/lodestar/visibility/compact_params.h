// SPDX-License-Identifier: Apache-2.0
#ifndef LS_COMPACT_PARAMS_H
#define LS_COMPACT_PARAMS_H
#include "record_params.h"
LS_NAMESPACE_BEGIN

const uint LS_COMPACT_GROUP = 64;  // threads of a workgroup, one a pixel

struct CompactVisibilityParams {
    uint width;     // of grid B
    uint firstRow;  // of the band, in grid B
    uint rows;      // of the band
    uint band;      // totals[band] words of lists come before this band's
    uint capacity;  // words that there is room for
};

LS_NAMESPACE_END
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_PREFIX_SUM_PARAMS_H
#define LS_PREFIX_SUM_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_SCAN_BLOCK = 1024;  // values one workgroup scans: 256 threads, 4 each

struct PrefixSumParams {
    uint count;        // values at this level
    uint source;       // first value, as an index into the buffer of all levels
    uint blockTotals;  // where this level's block totals go: the next level's first value
};

LS_NAMESPACE_END
#endif

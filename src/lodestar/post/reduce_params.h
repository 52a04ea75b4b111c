// SPDX-License-Identifier: Apache-2.0
#ifndef LS_REDUCE_PARAMS_H
#define LS_REDUCE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_REDUCE_BOX = 0u;
const uint LS_REDUCE_MITCHELL = 1u;

struct ReduceParams {
    uint factor;    // pixels of the large picture for one of the small, along an axis
    uint filterId;  // LS_REDUCE_…
};

LS_NAMESPACE_END
#endif

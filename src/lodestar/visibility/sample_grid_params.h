// SPDX-License-Identifier: Apache-2.0
#ifndef LS_SAMPLE_GRID_PARAMS_H
#define LS_SAMPLE_GRID_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct SampleGridParams {
    uvec2 size;      // of S
    uvec2 fullSize;  // of O
    float rate;      // r
};

LS_NAMESPACE_END
#endif

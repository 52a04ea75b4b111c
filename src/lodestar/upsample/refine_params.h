// SPDX-License-Identifier: Apache-2.0
#ifndef LS_REFINE_PARAMS_H
#define LS_REFINE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct RefineParams {
    uvec2 size;          // of S
    float rate;          // r
    float spread;        // texels whose neighbours lie no further apart than this are filled in
    float depthFalloff;  // as of UpsampleParams
    float normalFalloff;
    float unlike;  // −log2 of the least g·g of a neighbour it is filled in from
};

LS_NAMESPACE_END
#endif

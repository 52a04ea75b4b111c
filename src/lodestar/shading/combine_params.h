// SPDX-License-Identifier: Apache-2.0
#ifndef LS_COMBINE_PARAMS_H
#define LS_COMBINE_PARAMS_H
#include "../shared/types.h"
#include "../upsample/reconstruct_params.h"
LS_NAMESPACE_BEGIN

struct CombineParams {
    uvec2 size;  // of the part of the targets in use
};

struct CombineFromSParams {
    uvec2 size;
    ReconstructParams from;
};

LS_NAMESPACE_END
#endif

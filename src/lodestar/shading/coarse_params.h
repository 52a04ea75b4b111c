// SPDX-License-Identifier: Apache-2.0
#ifndef LS_COARSE_PARAMS_H
#define LS_COARSE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

/// Grid S over grid O. Texel j of S covers O pixels j·r … (j+1)·r; the last row and column may
/// reach past the edge.
struct CoarseParams {
    uvec2 size;      // of S
    uvec2 fullSize;  // of O
    float rate;      // r
};

LS_NAMESPACE_END
#endif

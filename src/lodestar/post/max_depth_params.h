// SPDX-License-Identifier: Apache-2.0
#ifndef LS_MAX_DEPTH_PARAMS_H
#define LS_MAX_DEPTH_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct MaxDepthParams {
    uvec2 size;  // of the larger picture
};

LS_NAMESPACE_END
#endif

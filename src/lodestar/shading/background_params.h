// SPDX-License-Identifier: Apache-2.0
#ifndef LS_BACKGROUND_PARAMS_H
#define LS_BACKGROUND_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct BackgroundParams {
    uvec2 size;  // of grid O
};

LS_NAMESPACE_END
#endif

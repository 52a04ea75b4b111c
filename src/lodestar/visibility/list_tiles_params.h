// SPDX-License-Identifier: Apache-2.0
#ifndef LS_LIST_TILES_PARAMS_H
#define LS_LIST_TILES_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct ListTilesParams {
    uvec2 size;  // of the grid
};

LS_NAMESPACE_END
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_LAYER_PARAMS_H
#define LS_LAYER_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_LAYER_ROW = 1024u;  // fragments in a row of their images

struct LayerParams {
    uvec2 size;      // of the layer's grid
    uvec2 fullSize;  // of grid O
    uint capacity;   // fragments that there is room for
};

LS_NAMESPACE_END
#endif

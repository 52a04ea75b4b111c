// SPDX-License-Identifier: Apache-2.0
#ifndef LS_REBUILD_PARAMS_H
#define LS_REBUILD_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct RebuildParams {
    vec2 pixelNdc;      // size of a pixel of grid O in NDC
    uvec2 size;         // of the part of `ids` in use
    vec2 textureScale;  // of texture gradients along x and y: 1, or less for a sharper mip level
};

LS_NAMESPACE_END
#endif

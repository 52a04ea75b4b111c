// SPDX-License-Identifier: Apache-2.0
#ifndef LS_EFFECTIVE_PARAMS_H
#define LS_EFFECTIVE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

/// Grid B of an effect over grid O. Texel j of B covers O pixels j·rate … (j+1)·rate; the last row
/// and column may reach past the edge, and are met at its last pixel's centre.
struct EffectiveGrid {
    uvec2 size;      // of B
    uvec2 fullSize;  // of O
    vec2 rate;       // O pixels a texel of B
};

LS_NAMESPACE_END
#endif

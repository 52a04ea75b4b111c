// SPDX-License-Identifier: Apache-2.0
#ifndef LS_COARSE_PARAMS_H
#define LS_COARSE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

// The terms, as channels of the term image and bits of a mask.
const uint LS_TERM_SHADOW = 1u;  // x: share of the sun that is seen
const uint LS_TERM_AO = 2u;      // y: share of the sky that is seen
const uint LS_TERM_NOISE = 4u;   // z: procedural pattern of the surface, 0 … 1
const uint LS_ALL_TERMS = 15u;

/// Grid S over grid O. Texel j of S covers O pixels j·r … (j+1)·r; the last row and column may
/// reach past the edge.
struct CoarseParams {
    uvec2 size;      // of S
    uvec2 fullSize;  // of O
    float rate;      // r
    uint terms;      // the terms to evaluate; others are 1
    uint yang;       // 1: what the paper's packing keeps (upsample::Packing)
    uint step;       // texels of S from one that is evaluated to the next
};

const vec4 kTermsOfBackground = vec4(1, 1, 0.5, 0);  // and where there are none

#ifndef __cplusplus
/// Where on grid O the centre of a texel of S lies, in pixels: within the picture.
vec2 centreOf(ivec2 texel, CoarseParams params) {
    return min((vec2(texel) + 0.5) * params.rate, vec2(params.fullSize) - 0.5);
}
#endif

LS_NAMESPACE_END
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_MOTION_BLUR_PARAMS_H
#define LS_MOTION_BLUR_PARAMS_H
#include "effective_params.h"
LS_NAMESPACE_BEGIN

const uint LS_MOTION_TILE = 8u;      // texels of B a side, of the tiles that know their fastest
const uint LS_MOTION_SAMPLES = 12u;  // of a texel

struct MotionBlurParams {
    EffectiveGrid grid;
    uvec2 tiles;    // tiles of B
    float shutter;  // 0 … 1
    float longest;  // half of the longest streak, in texels of B: two tiles at most
};

LS_NAMESPACE_END
#endif

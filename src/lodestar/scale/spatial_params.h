// SPDX-License-Identifier: Apache-2.0
#ifndef LS_SPATIAL_PARAMS_H
#define LS_SPATIAL_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_FILTER_POINT = 0u;
const uint LS_FILTER_BILINEAR = 1u;
const uint LS_FILTER_BICUBIC = 2u;
const uint LS_FILTER_NOISE = 3u;
const uint LS_FILTER_NOISE_OFFSET = 4u;
const uint LS_FILTER_EDGE_ADAPTIVE = 5u;

struct SpatialParams {
    vec2 step;       // texels of the live part a pixel of the output
    vec2 texelSize;  // 1 / size of the whole source
    vec2 last;       // where the last texel of the live part may be read [texels]
    vec2 live;       // size of the live part [texels]
    uvec2 size;      // of the output
    float amount;    // of noise: share of the code range, or texels
    uint seed;
};

LS_NAMESPACE_END
#endif

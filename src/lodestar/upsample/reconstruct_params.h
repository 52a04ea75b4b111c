// SPDX-License-Identifier: Apache-2.0
#ifndef LS_RECONSTRUCT_PARAMS_H
#define LS_RECONSTRUCT_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_DOMAIN_NEAREST = 0u;
const uint LS_DOMAIN_TENT = 1u;           // 2×2
const uint LS_DOMAIN_QUADRATIC = 2u;      // 3×3, quadratic B-spline
const uint LS_DOMAIN_CUBIC = 3u;          // 4×4, cubic B-spline
const uint LS_DOMAIN_GAUSSIAN = 4u;       // 4×4, σ = 0.7 texels of S
const uint LS_DOMAIN_NEAREST_DEPTH = 5u;  // of the 2×2 the one most like in depth, or their tent

struct ReconstructParams {
    uvec2 size;           // of S
    float inverseRate;    // 1/r
    float depthFalloff;   // log2(e) / (2 σz²); 0 for σz = ∞
    float normalFalloff;  // log2(e) / (2 σn²); 0 for σn = ∞
    float unlikeAbove;    // −log2 of the least g·g of the best tap that needs no repair
    float spreadAbove;    // nor do taps like the pixel that lie no further apart than this
};

LS_NAMESPACE_END
#endif

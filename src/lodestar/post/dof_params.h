// SPDX-License-Identifier: Apache-2.0
#ifndef LS_DOF_PARAMS_H
#define LS_DOF_PARAMS_H
#include "effective_params.h"
LS_NAMESPACE_BEGIN

struct DofParams {
    EffectiveGrid grid;
    float focus, sharp;  // F and n [scene units]
    float slope;         // d / (m − n)
    uint thesis;         // 1: what is before the focus stays sharp
    float cocFalloff;    // of the bilateral filter, log2(e) / (2 σ²); 0 = linear
    // Texels of B along x and along y for one of each of the three blurred pictures.
    uvec3 stepsX, stepsY;
};

/// A Gaussian along one axis, and a step to half the size.
struct DofBlurParams {
    uvec2 size;      // of what is written
    uvec2 fromSize;  // of what is read
    uvec2 axis;      // (1, 0) or (0, 1)
    uint step;       // texels read along the axis for one that is written
    uint reach;      // taps to each side
    float falloff;   // log2(e) / (2 σ²)
};

struct DofDownParams {
    DofParams lens;
    uvec2 size;  // of the larger picture
    uint first;  // 1: it is grid O, whose depths are at hand
};

LS_NAMESPACE_END
#endif

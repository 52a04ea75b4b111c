// SPDX-License-Identifier: Apache-2.0
#ifndef LS_SSAO_PARAMS_H
#define LS_SSAO_PARAMS_H
#include "effective_params.h"
LS_NAMESPACE_BEGIN

// Turn by the golden angle from one sample to the next.
const float LS_GOLDEN_COS = -0.73736888f;
const float LS_GOLDEN_SIN = 0.67549029f;
const float LS_GOLDEN_RATIO = 0.61803399f;

struct SsaoParams {
    EffectiveGrid grid;
    float radius;    // R [scene units]
    float bias;      // cosine above the surface from which something occludes
    float strength;  // factor of the mean
    uint samples;
};

LS_NAMESPACE_END
#endif

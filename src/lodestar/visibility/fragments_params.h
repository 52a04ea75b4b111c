// SPDX-License-Identifier: Apache-2.0
#ifndef LS_FRAGMENTS_PARAMS_H
#define LS_FRAGMENTS_PARAMS_H
#include "record_params.h"
LS_NAMESPACE_BEGIN

const uint LS_FRAGMENT_ROW = 1024;  // further fragments lie in images this wide

struct FragmentsParams {
    mat4 clipFromWorld;
    vec3 eye;       // world
    uvec2 base;     // grid B
    uint capacity;  // further fragments that there is room for
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::FragmentsParams) == 88);
#endif
#endif

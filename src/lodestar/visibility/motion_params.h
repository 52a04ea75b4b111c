// SPDX-License-Identifier: Apache-2.0
#ifndef LS_MOTION_PARAMS_H
#define LS_MOTION_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct MotionParams {
    mat4 previousClipFromWorld;  // without jitter
    uvec2 size;                  // of the part of `ids` in use
    uint firstDeformed;          // vertices from this on were elsewhere
};

LS_NAMESPACE_END
#endif

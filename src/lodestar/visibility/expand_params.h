// SPDX-License-Identifier: Apache-2.0
#ifndef LS_EXPAND_PARAMS_H
#define LS_EXPAND_PARAMS_H
#include "record_params.h"
LS_NAMESPACE_BEGIN

struct ExpandParams {
    mat4 clipFromWorld;  // of the capture
    uvec2 base;          // grid B
    uvec2 size;          // grid O
    uint maskedFrom;     // first cluster of the alpha-masked bins
};

LS_NAMESPACE_END
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_TONEMAP_PARAMS_H
#define LS_TONEMAP_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct TonemapParams {
    float exposure;
    uvec2 size;  // of the picture  // multiplies radiance
};

LS_NAMESPACE_END
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_GBUFFER_PARAMS_H
#define LS_GBUFFER_PARAMS_H
#include <lodestar/shared/types.h>
LS_NAMESPACE_BEGIN

struct GBufferParams {
    mat4 clipFromWorld;
    vec4 viewRow0, viewRow1, viewRow2;  // view from world, by rows
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::GBufferParams) == 112);
#endif
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_DEFERRED_PARAMS_H
#define LS_DEFERRED_PARAMS_H
#include <lodestar/shared/types.h>
LS_NAMESPACE_BEGIN

/// Of the shading that the reference renderer and the compact record are compared in.
struct PhongParams {
    mat4 clipFromWorld;
    vec3 eye;    // world
    uvec2 base;  // grid B of the record
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::PhongParams) == 84);
#endif
#endif

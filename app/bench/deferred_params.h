// SPDX-License-Identifier: Apache-2.0
#ifndef LS_DEFERRED_PARAMS_H
#define LS_DEFERRED_PARAMS_H
#include <lodestar/shared/types.h>
LS_NAMESPACE_BEGIN

/// Of the shading that the reference renderer and the compact record are compared in.
struct PhongParams {
    mat4 clipFromWorld;
    vec3 eye;        // world
    vec2 clipScale;  // clipFromView's [0][0] and [1][1]
    uvec2 base;      // grid B of the record
    vec4 viewRow2;   // third row of view from world
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::PhongParams) == 108);
#endif
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_VIEW_PARAMS_H
#define LS_VIEW_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

/// The eye of a frame, in a uniform buffer.
struct ViewParams {
    mat4 clipFromWorld;
    mat4 viewFromWorld;
    vec3 eye;        // world
    vec2 clipScale;  // clipFromView's [0][0] and [1][1]
    vec2 jitter;     // NDC by which the picture is moved; clipFromWorld does so
};

LS_NAMESPACE_END
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CULL_PARAMS_H
#define LS_CULL_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct CullParams {
    vec4 planes[5];     // world: inside where dot(plane, (p, 1)) ≥ 0; left, right, bottom, top, near
    vec3 eye;           // world, for normal cones
    uint clusterCount;
    uint useCones;      // 0 for orthographic views
};

struct EmitParams {
    uint binStarts[5];  // first cluster of each draw bin, and the end
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::CullParams) == 100);
#endif
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CULL_PARAMS_H
#define LS_CULL_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_CULL_GROUP = 256;     // threads of a workgroup with one thread a triangle slot
const uint LS_CLUSTER_SLOTS = 128;  // triangle slots of a cluster: 124, rounded up

struct CullClustersParams {
    vec4 planes[5];  // world: inside where dot(plane, (p, 1)) ≥ 0; left, right, bottom, top, near
    vec3 eye;        // world, for normal cones
    uint clusterCount;
    uint useCones;  // 0 for orthographic views
};

struct CompactParams {
    uint binStarts[5];  // first cluster of each draw bin, and the end
};

struct CullTrianglesParams {
    mat4 clipFromWorld;
    vec2 size;  // of the target, in pixels
    uint binStarts[5];
};

/// What the CPU never sees: how much there is to do, and where the bins begin.
struct VisibleCounts {
    uint groups[3];     // workgroups for one thread a triangle slot, for indirect dispatch
    uint clusters;      // visible
    uint binStarts[5];  // first visible cluster of each draw bin, and the end
};

#ifndef __cplusplus
/// Number of the thread in a dispatch of VisibleCounts::groups.
uint triangleSlot(uvec3 group, uvec3 groups, uint thread) {
    return (group.x + group.y * groups.x) * LS_CULL_GROUP + thread;
}
#endif

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::CullClustersParams) == 100);
static_assert(sizeof(lodestar::shared::CullTrianglesParams) == 92);
static_assert(sizeof(lodestar::shared::VisibleCounts) == 36);
#endif
#endif

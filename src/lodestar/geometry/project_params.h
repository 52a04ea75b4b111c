// SPDX-License-Identifier: Apache-2.0
#ifndef LS_PROJECT_PARAMS_H
#define LS_PROJECT_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_PROJECTED_STEPS = 256;  // of a sample that vertices snap to

// Flags of a projected vertex. Outside one plane of the view each:
const uint LS_PROJECTED_OUTSIDE = 31u;
const uint LS_PROJECTED_CLIP = 32u;  // before the near plane, or far beyond the picture: no place
// Of its cluster:
const uint LS_PROJECTED_REFLECTED = 64u;
const uint LS_PROJECTED_DOUBLE_SIDED = 128u;
const uint LS_PROJECTED_BITS = 8u;  // of the flags

/// Which clusters, and on which samples.
struct ProjectParams {
    mat4 clipFromWorld;  // of the whole picture
    uvec2 size;          // samples of it
    uint firstRow;       // of the band in view
    uint rows;
    uint phase;     // 0 or 1
    uint table;     // where the view's clusters begin in GpuScene::clusters
    uint capacity;  // clusters of the list whose vertices are kept: the first ones
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::ProjectParams) == 92);
#endif
#endif

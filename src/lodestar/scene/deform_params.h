// SPDX-License-Identifier: Apache-2.0
#ifndef LS_DEFORM_PARAMS_H
#define LS_DEFORM_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

// What a morph target has of each vertex.
const uint LS_DELTA_POSITION = 1u;
const uint LS_DELTA_NORMAL = 2u;
const uint LS_DELTA_TANGENT = 4u;

/// One instance's vertices; the numbers are of entries in the buffers of Deform.
struct DeformParams {
    uint firstVertex;  // in GpuScene::vertices, where they go
    uint vertexCount;
    uint firstRest;
    uint joints;  // a vertex; 0 = no skin
    uint firstInfluence;
    uint firstJoint;
    uint deltas;       // LS_DELTA_… of the mesh's targets
    uint deltaRows;    // how many those are
    uint firstActive;  // targets that have a weight
    uint activeCount;
};

struct DeformBoundsParams {
    uint firstMeshlet;
    uint meshletCount;
};

LS_NAMESPACE_END
#endif

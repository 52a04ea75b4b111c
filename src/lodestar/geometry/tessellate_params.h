// SPDX-License-Identifier: Apache-2.0
#ifndef LS_TESSELLATE_PARAMS_H
#define LS_TESSELLATE_PARAMS_H
#include "../scene/displacement.h"
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

/// In a uniform buffer.
struct TessellateParams {
    vec4 planes[5];  // of the view's frustum, as in CullParams
    vec3 eye;        // world
    float reach;     // edges are first halved nearer than their length times this
    uint pairs;      // with the unused first one
    uint instances;  // with the first, which is none
    uint capacity;   // triangles that can be refined
    uint total;      // where the number that should be stands in the scanned counts
    uint firstVertex, firstTriangle, firstMeshlet;
    uint secondUvs;  // whether there are any
};

/// Workgroups of the pass over the refined triangles, and what there was no place for.
struct TessellateHeader {
    uint groups[3];
    uint dropped;
};

LS_NAMESPACE_END
#endif

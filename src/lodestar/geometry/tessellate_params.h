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
    float reach;     // edges are first halved nearer than the wavelength times this
    uint pairs;      // with the unused first one
    uint capacity;   // triangles that can be refined
    uint total;      // where the number of all stands in the scanned counts
    uint firstVertex, firstTriangle, firstMeshlet;
    uint firstListed;  // place in GpuScene::meshletVertices
    uint secondUvs;    // whether there are any
};

// Reaches that are tried, each 1/√2 of the one before, until what is within has a place.
const uint LS_TESS_REACHES = 6;

struct TessellateHeader {
    uint groups[3];  // workgroups of the pass over the refined triangles
    uint unused;
    uint within[LS_TESS_REACHES];  // triangles within each reach
};

LS_NAMESPACE_END
#endif

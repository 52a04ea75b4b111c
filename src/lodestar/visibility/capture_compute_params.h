// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CAPTURE_COMPUTE_PARAMS_H
#define LS_CAPTURE_COMPUTE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_CAPTURE_GROUP = 64;       // threads of a workgroup
const uint LS_CAPTURE_TILE_WIDTH = 32;  // samples of a tile of grid C
const uint LS_CAPTURE_TILE_HEIGHT = 16;
const uint LS_CAPTURE_SPLITTERS = 8;       // threads that cut one large triangle
const uint LS_CAPTURE_CLIPPED = 262144;    // room for triangles to clip
const uint LS_CAPTURE_LARGE = 65536;       // room for large triangles
const uint LS_CAPTURE_JOBS = 1u << 19;     // room for tiles of large triangles
const uint LS_CAPTURE_MOST_GROUPS = 8192;  // workgroups over a queue

struct CaptureComputeParams {
    mat4 clipFromWorld;
    uvec2 size;         // of grid C
    uint firstRow;      // of the band, in grid C
    uint rows;          // of the band
    uint table;         // where the view's clusters begin in GpuScene::clusters
    vec2 textureScale;  // as CaptureParams has it
};

struct CaptureArgsParams {
    uint firstDraw;  // of the phase
    uint projected;  // whether vertices are, for this picture
};

/// Of one queue: opaque triangles or alpha-masked ones. Workgroups are for indirect dispatch; those
/// that take from a queue are set by who fills it.
struct CaptureQueueCounts {
    uint groups[3];       // one thread a triangle
    uint first;           // listed triangle
    uint slowGroups[3];   // the same, of clusters that are not projected
    uint count;           // of triangles
    uint projected;       // the first of them: those whose vertices are
    uint clipGroups[3];   // one thread a triangle
    uint clipped;         // those that must be clipped
    uint splitGroups[3];  // LS_CAPTURE_SPLITTERS threads a triangle
    uint large;           // those that are cut into tiles
    uint tileGroups[3];   // one a tile
    uint tiles;           // that some of them touch
    uint jobs;            // triangles in tiles
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::CaptureComputeParams) == 92);
static_assert(sizeof(lodestar::shared::CaptureQueueCounts) == 88);
#endif
#endif

// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CAPTURE_COMPUTE_PARAMS_H
#define LS_CAPTURE_COMPUTE_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_CAPTURE_GROUP = 64;     // threads of a workgroup
const uint LS_CAPTURE_TILE = 64;      // samples a side of a tile of grid C
const uint LS_CAPTURE_LARGE = 65536;  // room for large triangles
const uint LS_CAPTURE_JOBS = 262144;  // room for tiles of large triangles
const uint LS_CAPTURE_CLIPPED = 262144;  // room for triangles to clip
const uint LS_CAPTURE_LOOPS = 256;    // workgroups that share a queue of unknown length

struct CaptureComputeParams {
    mat4 clipFromWorld;
    uvec2 size;     // of grid C
    uint firstRow;  // of the band, in grid C
    uint rows;      // of the band
};

/// Of one queue: opaque triangles or alpha-masked ones.
struct CaptureQueueCounts {
    uint groups[3];  // workgroups for one thread a triangle, for indirect dispatch
    uint first;      // listed triangle
    uint count;      // of them
    uint clipped;    // those that must be clipped
    uint large;      // those that are cut into tiles
    uint jobs;       // the tiles
};

/// A triangle on the 1/256 sample grid, wound so that its inside is positive.
struct CaptureLarge {
    ivec2 v0, v1, v2;
    vec3 depth;  // z/w of the vertices
    uint id;
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::CaptureComputeParams) == 80);
static_assert(sizeof(lodestar::shared::CaptureLarge) == 40);
#endif
#endif

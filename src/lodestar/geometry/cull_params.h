// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CULL_PARAMS_H
#define LS_CULL_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

const uint LS_SPAN = 64;                           // threads of a workgroup with one thread an item
const uint LS_BLOCK = 1024;                        // values that one workgroup scans
const uint LS_WORDS = 4;                           // of a mask of a cluster's triangles, 32 each
const uint LS_WORD_CLUSTERS = LS_SPAN / LS_WORDS;  // of a workgroup with one thread a word

const uint LS_CULL_NONE = 0;     // every triangle of every instance is drawn
const uint LS_CULL_FRUSTUM = 1;  // also by normal cone, facing and size
const uint LS_CULL_HIZ = 2;      // also by what is in front

const uint LS_LOD_OFF = 0;
const uint LS_LOD_ERROR = 1;
const uint LS_LOD_DISTANCE = 2;

const uint LS_HIZ_LEVELS = 16;
const uint LS_HIZ_FIRST = 1;  // the finest level has one texel for 2×2 pixels

/// A view to cull for, in a uniform buffer.
struct CullParams {
    mat4 clipFromWorld;
    mat4 hizFromWorld0;  // clip space of the pyramid that the first phase tests with, the last
    mat4 hizFromWorld1;  // frame's; and the second, this frame's
    vec4 planes[5];  // world: inside where dot(plane, (p, 1)) ≥ 0; left, right, bottom, top, near
    vec3 eye;        // world, for normal cones
    uint mode;       // LS_CULL_*
    vec3 lodEye;     // world: whose distance counts
    float lodScale;  // error · scale / distance is in units of what is allowed
    vec4 distances0;  // where levels 1 … 8 begin
    vec4 distances1;
    vec2 size;  // of the target, in pixels
    uint lodMode;
    uint lodParallel;  // orthographic: the distance does not count
    uint useCones;     // 0 for orthographic views
    uint chunkCount;
    uint hizValid;  // whether there is a pyramid for the first phase
    uint hizLevels;
    vec2 hizSize;                    // pixels of the picture the pyramid is of
    uint listAll;                    // every meshlet has its place in the list, in view or not
    float reliefReach;               // relief is shown within its wavelength times this;
                                     // 0: what Tessellate left is not of this view
    uint hizOffsets[LS_HIZ_LEVELS];  // where each level begins; LS_HIZ_FIRST is the first there is
};

/// A list made on the device: how much is in it, and the dispatches that go over it.
struct CullList {
    uint groups[3];  // LS_SPAN threads, one an item
    uint count;
    uint blocks[3];  // LS_BLOCK items a workgroup
    uint dropped;    // what there was no place for
    uint words[3];   // LS_SPAN threads, LS_WORDS an item; never 0
    uint unused;
};

// Lists of a view. Those of the second phase follow those of the first.
const uint LS_LIST_CHUNKS = 0;      // of the scene
const uint LS_LIST_INSTANCES = 1;   // places for instances, in the visible chunks
const uint LS_LIST_CANDIDATES = 2;  // meshlets of the visible instances
const uint LS_LIST_CLUSTERS = 3;    // visible ones of these
const uint LS_LIST_TRIANGLES = 4;
const uint LS_LIST_CANDIDATES_2 = 5;
const uint LS_LIST_CLUSTERS_2 = 6;
const uint LS_LIST_TRIANGLES_2 = 7;
const uint LS_LISTS = 8;

/// A dispatch over the clusters of a phase that there was no room to project.
struct CullBeyond {
    uint groups[3];
};

/// What the CPU never sees within a frame.
struct CullCounts {
    CullList lists[LS_LISTS];
    uint instances;        // visible
    uint instancesHidden;  // by what the last frame showed: looked at again in the second phase
    uint instancesFound;   // of these, by the second phase
    uint clustersHidden;
    CullBeyond beyond[2];
    uint projected[2];  // end of the phase's triangles whose vertices are projected: in the list
};

struct ScanParams {
    uint source;    // the list that was scanned
    uint result;    // the list its total is the length of
    uint times;     // items of `result` a unit
    uint capacity;  // of `result`
    uint before;    // a list that shares the capacity and comes first; `result` itself: none
    uint totals;    // where the block totals stand, as an index into the values
};

struct PhaseParams {
    uint phase;  // 0 or 1
    uint table;  // where the view's clusters begin in GpuScene::clusters
};

struct EmitParams {
    PhaseParams phase;
    uint totals;    // as in ScanParams
    uint capacity;  // as in ProjectParams
};

struct HizParams {
    uvec2 from;  // size of the level read
    uvec2 to;    // size of the level written
    uint fromOffset, toOffset;
    vec2 scale;  // of the first level: pixels of the depth image a pixel of the pyramid's picture
};

#ifndef __cplusplus
/// Number of the thread in a dispatch of up to two dimensions.
uint linearThread(uvec3 group, uvec3 groups, uint perGroup, uint thread) {
    return (group.x + group.y * groups.x) * perGroup + thread;
}

/// Cluster and word of a thread where each has LS_WORDS. Neighbours have the same word of different
/// clusters: the last words are empty as a rule, and are then left by all lanes at once.
uvec2 clusterAndWord(uvec3 group, uvec3 groups, uint thread) {
    return uvec2(linearThread(group, groups, LS_WORD_CLUSTERS, thread % LS_WORD_CLUSTERS),
                 thread / LS_WORD_CLUSTERS);
}
#endif

// Bits of an instance's state, above its number (25 bits) and level (4).
const uint LS_STATE_INSTANCE = 0x1ffffffu;
const uint LS_STATE_LOD_SHIFT = 25u;
const uint LS_STATE_DRAWN = 1u << 29;   // its clusters were looked at in the first phase
const uint LS_STATE_HIDDEN = 1u << 30;  // behind what the last frame showed
const uint LS_STATE_PARTLY = 1u << 31;  // some of its clusters were

const uint LS_CANDIDATE_VISIBLE = 1u << 31;  // beside a meshlet's number

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::CullParams) == 448);
static_assert(sizeof(lodestar::shared::CullList) == 48);
static_assert(sizeof(lodestar::shared::CullCounts) == 432);
#endif
#endif

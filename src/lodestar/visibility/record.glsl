// SPDX-License-Identifier: Apache-2.0
// Reading the compact record (record_params.h). The includer defines LS_HEADS_BINDING and
// LS_LISTS_BINDING, and has declared the specialization constant kSide: s.
#ifndef LS_RECORD_GLSL
#define LS_RECORD_GLSL
#include "record_params.h"
#include "coverage.glsl"

layout(binding = LS_HEADS_BINDING) uniform usamplerBuffer recordHeads;
layout(binding = LS_LISTS_BINDING) uniform usamplerBuffer recordLists;

const uint kMaskWords = kSide == 8 ? 2 : 1;
struct Head {
    uint id;    // the representative
    uint list;  // where its ids stand, this one first
    bool listed;
};

Head loadHead(uint pixel) {
    const uint word = texelFetch(recordHeads, int(pixel)).x;
    const uint at = word & ~LS_HEAD_LIST;
    if (word == at) return Head(word, 0, false);
    return Head(texelFetch(recordLists, int(at)).x, at, true);
}

/// An id of a list as it stands there: with LS_LAST_NODE.
uint loadListed(uint at) { return texelFetch(recordLists, int(at)).x; }

/// What a pixel shows. Without a list, one id and no planes.
struct List {
    uint ids, count;
    uint planes, planeCount;
};

List loadList(Head head) {
    List list = List(head.list, 1, 0, 0);
    // A loop without iterations for pixels without a list: some drivers run both sides of a branch.
    for (uint at = head.list; head.listed; ++at) {
        if ((loadListed(at) & LS_LAST_NODE) == 0) continue;
        list.count = at - head.list + 1;
        list.planes = at + 1;
        list.planeCount = uint(findMSB(list.count - 1)) + 1;
        break;
    }
    return list;
}

uvec2 loadPlane(List list, uint plane) {
    const uint at = list.planes + plane * kMaskWords;
    return uvec2(loadListed(at), kMaskWords == 2 ? loadListed(at + 1) : 0);
}

/// The id of number k, not of k = 0 where there is no list: that is the head's.
uint listedId(List list, uint k) { return loadListed(list.ids + k) & ~LS_LAST_NODE; }

/// The samples that show it.
uvec2 listedMask(List list, uint k) {
    uvec2 mask = kAllSamples;
    for (uint i = 0; i < list.planeCount; ++i) {
        const uvec2 plane = loadPlane(list, i);
        mask &= (k >> i & 1) != 0 ? plane : ~plane;
    }
    return mask;
}

/// The number of the id that a sample shows.
uint shownBy(List list, uint sample_) {
    uint k = 0;
    for (uint i = 0; i < list.planeCount; ++i) {
        const uvec2 plane = loadPlane(list, i);
        k |= ((sample_ < 32 ? plane.x : plane.y) >> (sample_ & 31) & 1) << i;
    }
    return k;
}

#endif

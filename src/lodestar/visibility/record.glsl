// SPDX-License-Identifier: Apache-2.0
// Reading the compact record (record_params.h). The includer defines LS_HEADS_BINDING and
// LS_LISTS_BINDING, and has declared the specialization constant kSide: s.
#ifndef LS_RECORD_GLSL
#define LS_RECORD_GLSL
#include "record_params.h"

layout(binding = LS_HEADS_BINDING) uniform usamplerBuffer recordHeads;
layout(binding = LS_LISTS_BINDING) uniform usamplerBuffer recordLists;

const uint kNodeWords = kSide == 8 ? 3 : 2;

struct Head {
    uint id;    // the representative
    uint list;  // its first node, kNodeWords from one to the next
    bool listed;
};

struct Node {
    uint id;  // with LS_LAST_NODE
    uvec2 mask;
};

Head loadHead(uint pixel) {
    const uint word = texelFetch(recordHeads, int(pixel)).x;
    const uint at = word & ~LS_HEAD_LIST;
    if (word == at) return Head(word, 0, false);
    return Head(texelFetch(recordLists, int(at)).x, at + 1, true);
}

Node loadNode(uint at) {
    return Node(texelFetch(recordLists, int(at)).x,
                uvec2(texelFetch(recordLists, int(at + 1)).x,
                      kNodeWords == 3 ? texelFetch(recordLists, int(at + 2)).x : 0));
}

bool shows(Node node, uint sample_) {
    return ((sample_ < 32 ? node.mask.x : node.mask.y) >> (sample_ & 31) & 1) != 0;
}

#endif

// SPDX-License-Identifier: Apache-2.0
// Reading the compact record. The includer defines LS_HEADS_BINDING and LS_NODES_BINDING.
#ifndef LS_RECORD_GLSL
#define LS_RECORD_GLSL
#include "record_params.h"

layout(binding = LS_HEADS_BINDING) uniform usamplerBuffer recordHeads;
layout(binding = LS_NODES_BINDING) uniform usamplerBuffer recordNodes;

VisibilityHead loadHead(uint pixel) {
    const uvec2 w = texelFetch(recordHeads, int(pixel)).xy;
    return VisibilityHead(w.x, w.y);
}

VisibilityNode loadNode(uint index) {
    const int at = int(3 * index);
    return VisibilityNode(texelFetch(recordNodes, at).x, texelFetch(recordNodes, at + 1).x,
                          texelFetch(recordNodes, at + 2).x);
}

bool hasList(VisibilityHead head) { return head.list < LS_LIST_EMPTY; }

bool shows(VisibilityNode node, uint sample_) {
    return ((sample_ < 32 ? node.maskLow : node.maskHigh) >> (sample_ & 31) & 1) != 0;
}

#endif

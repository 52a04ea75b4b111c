// SPDX-License-Identifier: Apache-2.0
#ifndef LS_RECORD_PARAMS_H
#define LS_RECORD_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

// The compact visibility record: a head a pixel of grid B and a list of nodes for each pixel whose
// samples show more than one triangle. Sample (x, y) of a pixel is bit y·s + x of a mask.

const uint LS_LIST_NONE = 0xffffffffu;   // VisibilityHead::list: all samples show `id`
const uint LS_LIST_EMPTY = 0xfffffffeu;  // the same, and `id` is the background
const uint LS_LAST_NODE = 0x80000000u;   // bit of VisibilityNode::id: the list ends here

struct VisibilityHead {
    uint id;    // the representative: most samples; of equals the smaller id
    uint list;  // first node, or one of the above
};

/// A further triangle (or the background, 0) of a pixel. Nodes of a pixel stand together, by their
/// first samples. The representative has what their masks leave.
struct VisibilityNode {
    uint id;                 // with LS_LAST_NODE
    uint maskLow, maskHigh;  // samples 0 … 31 and 32 … 63
};

LS_NAMESPACE_END
#ifdef __cplusplus
static_assert(sizeof(lodestar::shared::VisibilityHead) == 8);
static_assert(sizeof(lodestar::shared::VisibilityNode) == 12);
#endif
#endif

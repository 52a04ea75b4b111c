// SPDX-License-Identifier: Apache-2.0
#ifndef LS_RECORD_PARAMS_H
#define LS_RECORD_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

// The compact visibility record: a word a pixel of grid B, and a pool of words with a list for each
// pixel whose samples show more than one triangle. Sample (x, y) of a pixel is bit y·s + x of a
// mask.
//
// A head is the id that all samples show (0 = background), or LS_HEAD_LIST | where the list starts.
// A list is the representative (most samples; of equals the smaller id), then nodes: an id, with
// LS_LAST_NODE in the last one, and its mask, one word or, of 64 samples, two. Nodes go by their
// first samples. The representative has what their masks leave.

const uint LS_HEAD_LIST = 0x80000000u;
const uint LS_LAST_NODE = 0x80000000u;

LS_NAMESPACE_END
#endif

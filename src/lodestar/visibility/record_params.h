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
// A list is n ids, then which of them each sample shows. The first id is the representative (most
// samples; of equals the smaller id), the others go by their first samples, and the last one has
// LS_LAST_NODE. Samples say their id's number, 0 … n − 1, in planes of a bit each, the lowest
// first: ⌈log₂ n⌉ masks, of one word or, of 64 samples, two. The mask of id k is what in every
// plane has the bit that k has: of 64 samples n ids take n + 2·⌈log₂ n⌉ words, with masks it were
// 3·n.

const uint LS_HEAD_LIST = 0x80000000u;
const uint LS_LAST_NODE = 0x80000000u;

LS_NAMESPACE_END
#endif

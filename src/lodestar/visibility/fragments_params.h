// SPDX-License-Identifier: Apache-2.0
#ifndef LS_FRAGMENTS_PARAMS_H
#define LS_FRAGMENTS_PARAMS_H
#include "record_params.h"
LS_NAMESPACE_BEGIN

const uint LS_FRAGMENT_ROW = 256;  // further fragments lie in images this wide
const uint LS_MERGE_GROUPS = 512;  // of 64 threads, for all mixed pixels

struct FragmentsParams {
    uvec2 base;     // grid B
    uint capacity;  // further fragments that there is room for
};

/// What was found, counted on the device.
struct FragmentCounts {
    uint mixed;    // pixels that list several triangles
    uint pixels;   // of those, pixels that need further fragments
    uint further;  // further fragments
};

/// A pixel that needs further fragments: they lie one after the other.
struct FurtherPixel {
    uint pixel;
    uint first, count;  // its further fragments
};

LS_NAMESPACE_END
#endif

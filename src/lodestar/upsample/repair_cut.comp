// SPDX-License-Identifier: Apache-2.0
#version 460
#include "upsample_params.h"

// One thread: from which bin on the listed pixels fit under the cap, and what share of the next.
layout(local_size_x = 1) in;

layout(binding = 0, scalar) buffer Header { RepairHeader repair; };
layout(push_constant, scalar) uniform Push { RepairSelectParams params; };

void main() {
    uint cut = LS_REPAIR_BINS, fitting = 0;
    while (cut > 0 && fitting + repair.bins[cut - 1] <= params.most) fitting += repair.bins[--cut];
    repair.cut = cut;
    repair.partOf = 0;
    if (cut > 0) {
        // Chosen by lot: four standard deviations less than what there is room for.
        const float room = float(params.most - fitting);
        const float share = max(room - 4 * sqrt(room), 0) / float(repair.bins[cut - 1]);
        repair.partOf = uint(share * 4294967040.0);
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "upsample_params.h"

// One thread: from which bin on the listed pixels fit under the cap.
layout(local_size_x = 1) in;

layout(binding = 0, scalar) buffer Header { RepairHeader repair; };
layout(push_constant, scalar) uniform Push { RepairSelectParams params; };

void main() {
    uint cut = LS_REPAIR_BINS, fitting = 0;
    while (cut > 0 && fitting + repair.bins[cut - 1] <= params.most) fitting += repair.bins[--cut];
    repair.cut = cut;
    repair.groups = uint[3]((fitting + 63) / 64, 1, 1);
}

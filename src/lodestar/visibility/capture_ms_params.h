// SPDX-License-Identifier: Apache-2.0
#ifndef LS_CAPTURE_MS_PARAMS_H
#define LS_CAPTURE_MS_PARAMS_H
#include "../shared/types.h"
LS_NAMESPACE_BEGIN

struct CaptureMsDrawParams {
    mat4 clipFromWorld;  // shifted; first, where capture_ss.vert looks for it
    vec2 size;           // that clip space spans [pixels of the target]
    float firstRow;      // of the band, in the target
};

struct CaptureMsParams {
    vec2 shift;  // of the geometry in this pass [pixels of the target]
    uvec2 size;  // of the band of grid C
};

#ifndef __cplusplus
/// The standard sample locations of Vulkan, in pixels.
vec2 sampleLocation(uint i, uint samples) {
    const ivec2 two[2] = {{12, 12}, {4, 4}};
    const ivec2 four[4] = {{6, 2}, {14, 6}, {2, 10}, {10, 14}};
    const ivec2 eight[8] = {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}};
    return vec2(samples == 2 ? two[i & 1] : samples == 4 ? four[i & 3] : eight[i & 7]) / 16;
}
#endif

LS_NAMESPACE_END
#endif

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "capture_ms_params.h"

// Puts every sample of one shifted multisample pass where it belongs in grid C, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kSide = 4;
layout(constant_id = 1) const uint kSamples = 4;  // a pixel of the target: 2, 4 or 8

layout(binding = 0) uniform sampler2DMS target;
layout(binding = 1, r32ui) writeonly uniform uimage2D outIds;
layout(push_constant, scalar) uniform Push { CaptureMsParams params; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, textureSize(target)))) return;
    for (uint i = 0; i < kSamples; ++i) {
        // The target has a pixel more at the left and the top, for what the shift moves there.
        const vec2 at = vec2(pixel - 1) + sampleLocation(i, kSamples) + params.shift;
        const ivec2 cell = ivec2(floor(at * kSide));
        const uint id = packUnorm4x8(texelFetch(target, pixel, int(i)));
        if (all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, ivec2(params.size))))
            imageStore(outIds, cell, uvec4(id));
    }
}

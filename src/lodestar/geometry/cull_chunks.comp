// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/gpu_types.h"
#include "cull_params.h"

// One thread a chunk of instances: 1 when its bounding sphere meets the view, else 0.
layout(local_size_x = LS_SPAN) in;

layout(binding = 0, scalar) uniform Params { CullParams params; };
layout(binding = 1) uniform usamplerBuffer chunks;
layout(binding = 2, scalar) writeonly buffer Flags { uint flags[]; };

#include "cull_test.glsl"

void main() {
    const uint index = linearThread(gl_WorkGroupID, gl_NumWorkGroups, LS_SPAN,
                                    gl_LocalInvocationID.x);
    if (index >= params.chunkCount) return;
    const vec4 sphere = uintBitsToFloat(texelFetch(chunks, int(2 * index)));
    flags[index] =
        params.mode == LS_CULL_NONE || params.listAll != 0 || inFrustum(sphere.xyz, sphere.w) ? 1 : 0;
}

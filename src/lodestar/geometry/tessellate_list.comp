// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "cull_params.h"
#include "tessellate_params.h"

// One thread a meshlet of a displaced instance: gives each triangle marked its place.
layout(local_size_x = LS_SPAN) in;

layout(binding = 6, scalar) uniform Params { TessellateParams params; };
layout(binding = 7) uniform usamplerBuffer displaced;
layout(binding = 8) uniform usamplerBuffer pairs;
layout(binding = 9, scalar) readonly buffer Masks { uvec4 masks[]; };
layout(binding = 10, scalar) readonly buffer Offsets { uint offsets[]; };
layout(binding = 11, scalar) writeonly buffer Entries { uvec2 entries[]; };  // pair, triangle
layout(binding = 12, scalar) writeonly buffer Refined { uvec2 refined[]; };
layout(binding = 13, scalar) writeonly buffer Header { TessellateHeader header; };

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index >= params.pairs) return;
    const uint total = offsets[params.total];
    if (index == 0) {
        header.groups = uint[](total, 1, 1);
        refined[0] = uvec2(0);
        return;
    }
    const uvec2 pair = texelFetch(pairs, int(index)).xy;
    const uvec4 span = texelFetch(displaced, int(2 * pair.x + 1));
    if (index == span.x) {
        const uint end = index + span.z < params.pairs ? offsets[index + span.z] : total;
        refined[pair.x] = uvec2(params.firstMeshlet + offsets[index], end - offsets[index]);
    }
    const uvec4 mask = masks[index];
    uint place = offsets[index];
    for (uint word = 0; word < 4; ++word)
        for (uint left = mask[word]; left != 0; left &= left - 1, ++place)
            entries[place] = uvec2(index, 32 * word + uint(findLSB(left)));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../gpu/texel_list_params.h"
#include "../upsample/coarse_texel.glsl"
#include "coarse_params.h"

// One thread a texel of grid S: those that show a surface are listed, a tile's in one run so that
// neighbours stay neighbours; of the others the background's terms are written.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2D ids;
layout(binding = 1, rgba32ui) writeonly uniform uimage2D outCoarse;
layout(binding = 2, scalar) buffer Header { TexelListHeader list; };
layout(binding = 3, scalar) writeonly buffer Texels { uint texels[]; };
layout(push_constant, scalar) uniform Push { CoarseParams params; };

#include "../gpu/texel_list.glsl"

shared uint found, first;

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * int(params.step);
    const bool inside = all(lessThan(texel, ivec2(params.size)));
    const ivec2 pixel = ivec2(centreOf(min(texel, ivec2(params.size) - 1), params));
    const bool covered = inside && texelFetch(ids, pixel, 0).x != 0;
    if (gl_LocalInvocationIndex == 0) found = 0;
    barrier();
    const uint place = covered ? atomicAdd(found, 1) : 0;
    barrier();
    if (gl_LocalInvocationIndex == 0 && found > 0) first = reserveTexels(found);
    barrier();
    if (covered)
        texels[first + place] = packTexel(texel);
    else if (inside)
        imageStore(outCoarse, texel, packCoarse(kTermsOfBackground, vec3(0, 0, 1), 0));
}

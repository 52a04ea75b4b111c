// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../gpu/texel_list_params.h"
#include "../shared/octahedral.h"
#include "coarse_texel.glsl"
#include "refine_params.h"

// One thread a texel of S that was evaluated (every second one of every second row): the three to
// its right, below and diagonally below are filled in, or listed.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D depth;    // of O
layout(binding = 1) uniform usampler2D normal;  // of O
layout(binding = 2) uniform usampler2D coarse;
layout(binding = 3, rgba32ui) writeonly uniform uimage2D outCoarse;
layout(binding = 4, scalar) buffer Header { TexelListHeader list; };
layout(binding = 5, scalar) writeonly buffer Texels { uint texels[]; };
layout(push_constant, scalar) uniform Push { RefineParams params; };

#include "../gpu/texel_list.glsl"

void main() {
    const ivec2 first = 2 * ivec2(gl_GlobalInvocationID.xy);
    const ivec2 size = ivec2(params.size);
    if (any(greaterThanEqual(first, size))) return;
    const ivec2 last = (size - 1) & ~1;  // that was evaluated
    const ivec2 next = min(first + 2, last);
    const uvec4 corner[4] = uvec4[4](
        texelFetch(coarse, first, 0), texelFetch(coarse, ivec2(next.x, first.y), 0),
        texelFetch(coarse, ivec2(first.x, next.y), 0), texelFetch(coarse, next, 0));

    for (int k = 1; k < 4; ++k) {
        const ivec2 texel = first + ivec2(k & 1, k >> 1);
        if (any(greaterThanEqual(texel, size))) continue;
        const ivec2 pixel = ivec2(min((vec2(texel) + 0.5) * params.rate,
                                      vec2(textureSize(depth, 0)) - 0.5));
        const float z = texelFetch(depth, pixel, 0).x;
        const vec3 n = z > 0 ? unpackNormal(texelFetch(normal, pixel, 0).x) : vec3(0, 0, 1);
        const vec2 bent = foreshortened(n);
        float e[4], least = 3e38;
        for (int j = 0; j < 4; ++j) {
            const float tapZ = coarseDepth(corner[j]);
            const float dz = z > 0 ? (z - tapZ) / z : 0;
            const vec2 dn = bent - coarseNormal(corner[j]);
            e[j] = params.depthFalloff * dz * dz + params.normalFalloff * dot(dn, dn);
            least = min(least, e[j]);
        }
        // The taps on the line of the texel make it: each must be like it. All that are like it,
        // beside the line too, must agree.
        float worst = 0;
        vec4 sum = vec4(0), low = vec4(3e38), high = vec4(-3e38);
        float weights = 0;
        for (int j = 0; j < 4; ++j) {
            const vec4 values = coarseTerms(corner[j]);
            const bool like = e[j] <= least + 2;
            low = like ? min(low, values) : low;
            high = like ? max(high, values) : high;
            const bool onLine = (j & ~k) == 0;
            worst = onLine ? max(worst, e[j]) : worst;
            const float w = onLine ? exp2(clamp(least - e[j], -126.0, 0.0)) : 1e-30;
            sum += w * values;
            weights += w;
        }
        const vec4 apart = high - low;
        const float spread = max(max(apart.x, apart.y), max(apart.z, apart.w));
        if (z == 0 || (worst <= params.unlike && spread <= params.spread))
            imageStore(outCoarse, texel, packCoarse(sum / weights, n, z));
        else
            texels[reserveTexels(1)] = packTexel(texel);
    }
}

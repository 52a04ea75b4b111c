// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../gpu/texel_list_params.h"
#include "../upsample/coarse_texel.glsl"
#include "coarse_terms.glsl"

// The coarse terms of listed texels of grid S, one thread each: those of the surface seen through
// its centre.
layout(local_size_x = 64) in;

layout(binding = 11, rgba32ui) writeonly uniform uimage2D outCoarse;
layout(binding = 12, scalar) buffer Header { TexelListHeader list; };
layout(binding = 13, scalar) readonly buffer Texels { uint texels[]; };
layout(push_constant, scalar) uniform Push { CoarseParams params; };

#include "../gpu/texel_list.glsl"

void main() {
    const uint place = placeOfThread();
    if (place >= list.listed) return;
    const ivec2 texel = unpackTexel(texels[place]);
    // The triangle is that of the O pixel under the texel's centre; its plane is then met exactly
    // at the centre, so that the grid is regular at any r.
    const vec2 centre = centreOf(texel, params);
    const uint id = texelFetch(ids, ivec2(centre), 0).x;
    const SurfacePoint at = surfacePoint(id, centre / vec2(params.fullSize) * 2 - 1);
    const vec4 terms = evaluateTerms(at, params.terms);
    const vec3 normal = mat3(view.viewFromWorld) * at.normal;
    imageStore(outCoarse, texel,
               params.yang != 0 ? packCoarseYang(terms, normal, at.depth)
                                : packCoarse(terms, normal, at.depth));
}

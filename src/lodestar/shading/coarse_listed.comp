// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../upsample/coarse_texel.glsl"
#include "../upsample/refine_params.h"
#include "coarse_terms.glsl"

// The coarse terms of listed texels of grid S, one thread each.
layout(local_size_x = 64) in;

layout(binding = 11, rgba32ui) writeonly uniform uimage2D outCoarse;
layout(binding = 12, scalar) readonly buffer Header { RefineHeader refine; };
layout(binding = 13, scalar) readonly buffer Listed { uint listed[]; };
layout(push_constant, scalar) uniform Push { CoarseParams params; };

void main() {
    if (gl_GlobalInvocationID.x >= refine.listed) return;
    const uint entry = listed[gl_GlobalInvocationID.x];
    const ivec2 texel = ivec2(entry & 0xffffu, entry >> 16);
    const vec2 centre = centreOf(texel, params);
    const uint id = texelFetch(ids, ivec2(centre), 0).x;
    const SurfacePoint at = surfacePoint(id, centre / vec2(params.fullSize) * 2 - 1);
    const vec4 terms = evaluateTerms(at, params.terms);
    const vec3 normal = mat3(view.viewFromWorld) * at.normal;
    imageStore(outCoarse, texel,
               params.yang != 0 ? packCoarseYang(terms, normal, at.depth)
                                : packCoarse(terms, normal, at.depth));
}

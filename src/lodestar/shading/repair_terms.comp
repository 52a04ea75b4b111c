// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../upsample/upsample_params.h"
#include "coarse_terms.glsl"

// The coarse terms at full rate, one thread a listed pixel.
layout(local_size_x = 64) in;

layout(binding = 11, rgba16f) uniform image2D outTerms;
layout(binding = 12, scalar) readonly buffer Header { RepairHeader repair; };
layout(binding = 13, scalar) readonly buffer Kept { uint kept[]; };
layout(push_constant, scalar) uniform Push { CoarseParams params; };

void main() {
    if (gl_GlobalInvocationID.x >= repair.kept) return;
    const uint index = kept[gl_GlobalInvocationID.x];
    const ivec2 pixel = ivec2(index % params.fullSize.x, index / params.fullSize.x);
    const SurfacePoint at = surfacePoint(texelFetch(ids, pixel, 0).x,
                                         (vec2(pixel) + 0.5) / vec2(params.fullSize) * 2 - 1);
    const bvec4 chosen = notEqual(uvec4(params.terms) & uvec4(1, 2, 4, 8), uvec4(0));
    imageStore(outTerms, pixel,
               mix(imageLoad(outTerms, pixel), evaluateTerms(at, params.terms), chosen));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/tiles.glsl"
#include "coarse_terms.glsl"

// The terms on grid O, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kMerge = 0;   // 1: some of them, keep the others
layout(constant_id = 1) const uint kPoints = 0;  // 1: at `points`, not at the centres of pixels

layout(binding = 11, rgba16f) uniform image2D outTerms;
layout(binding = 12) uniform sampler2D points;  // NDC
layout(binding = 13) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push { CoarseParams params; };

void write(ivec2 pixel, vec4 terms) {
    if (kMerge != 0) {
        const bvec4 chosen = notEqual(uvec4(params.terms) & uvec4(1, 2, 4, 8), uvec4(0));
        terms = mix(imageLoad(outTerms, pixel), terms, chosen);
    }
    imageStore(outTerms, pixel, terms);
}

void main() {
    const ivec2 pixel = pixelOfThread(tiles);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const uint id = texelFetch(ids, pixel, 0).x;
    if (id == 0) {
        write(pixel, kTermsOfBackground);
        return;
    }
    const vec2 ndc = kPoints != 0 ? texelFetch(points, pixel, 0).xy
                                  : (vec2(pixel) + 0.5) / vec2(params.fullSize) * 2 - 1;
    write(pixel, evaluateTerms(surfacePoint(id, ndc), params.terms));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/tiles.glsl"
#include "../upsample/coarse_texel.glsl"
#include "coarse_terms.glsl"

// The coarse terms on grid S, one thread a texel: those of the surface seen through its centre.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kFullRate = 0;  // 1: S is O, write the terms alone
layout(constant_id = 1) const uint kMerge = 0;     // 1: … some of them, keep the others
layout(constant_id = 2) const uint kPoints = 0;    // 1: at `points`, not at the centres of texels

// One binding, of which the constant picks the reading.
layout(binding = 11, rgba32ui) writeonly uniform uimage2D outCoarse;
layout(binding = 11, rgba16f) uniform image2D outTerms;
layout(binding = 12) uniform sampler2D points;  // NDC
layout(binding = 13) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push { CoarseParams params; };

void write(ivec2 texel, vec4 terms, vec3 viewNormal, float depth) {
    if (kMerge != 0) {
        const bvec4 chosen = notEqual(uvec4(params.terms) & uvec4(1, 2, 4, 8), uvec4(0));
        terms = mix(imageLoad(outTerms, texel), terms, chosen);
    }
    if (kFullRate != 0)
        imageStore(outTerms, texel, terms);
    else
        imageStore(outCoarse, texel,
                   params.yang != 0 ? packCoarseYang(terms, viewNormal, depth)
                                    : packCoarse(terms, viewNormal, depth));
}

void main() {
    const ivec2 texel = pixelOfThread(tiles) * int(params.step);
    if (any(greaterThanEqual(texel, ivec2(params.size)))) return;
    // The triangle is that of the O pixel under the texel's centre; its plane is then met exactly
    // at the centre, so that the grid is regular at any r.
    const vec2 centre = centreOf(texel, params);
    const uint id = texelFetch(ids, ivec2(centre), 0).x;
    const vec2 ndc = kPoints != 0 ? texelFetch(points, texel, 0).xy
                                  : centre / vec2(params.fullSize) * 2 - 1;
    if (id == 0) {
        write(texel, kTermsOfBackground, vec3(0, 0, 1), 0);
        return;
    }
    const SurfacePoint at = surfacePoint(id, ndc);
    write(texel, evaluateTerms(at, params.terms), mat3(view.viewFromWorld) * at.normal, at.depth);
}

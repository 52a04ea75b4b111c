// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../visibility/triangle.glsl"
#include "../visibility/view_params.h"
#include "../upsample/coarse_texel.glsl"
#include "coarse_params.h"
#include "shadow.glsl"
#include "sky.glsl"

// The expensive, smooth terms on grid S, one thread a texel: sun visibility and sky irradiance of
// the surface seen through the texel's centre.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 1) const uint kPoints = 0;    // 1: at `points`, not at the centres of texels
layout(constant_id = 0) const uint kFullRate = 0;  // 1: S is O, write the terms alone

layout(binding = 6, scalar) uniform View { ViewParams view; };
layout(binding = 7, scalar) uniform Light { LightParams light; };
layout(binding = 8) uniform usampler2D ids;
layout(binding = 9) uniform sampler2D shadowMap;
// One binding, of which the constant picks the reading.
layout(binding = 10, rgba32ui) writeonly uniform uimage2D outCoarse;
layout(binding = 10, rgba16f) writeonly uniform image2D outTerms;
layout(binding = 11) uniform sampler2D points;  // NDC
layout(push_constant, scalar) uniform Push { CoarseParams params; };

void write(ivec2 texel, vec4 terms, vec3 viewNormal, float depth) {
    if (kFullRate != 0)
        imageStore(outTerms, texel, terms);
    else
        imageStore(outCoarse, texel, packCoarse(terms, viewNormal, depth));
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.size)))) return;
    // The triangle is that of the O pixel under the texel's centre; its plane is then met exactly
    // at the centre, so that the grid is regular at any r.
    const vec2 centre = (vec2(texel) + 0.5) * params.rate;
    const vec2 inside = min(centre, vec2(params.fullSize) - 0.5);
    const uint id = texelFetch(ids, ivec2(inside), 0).x;
    const vec2 ndc = kPoints != 0 ? texelFetch(points, texel, 0).xy
                                  : inside / vec2(params.fullSize) * 2 - 1;
    if (id == 0) {
        write(texel, vec4(0, 0, 0, 1), vec3(0, 0, 1), 0);
        return;
    }

    const Triangle t = loadTriangle(id);
    Barycentrics b =
        barycentricsAt(view.clipFromWorld * vec4(t.p0, 1), view.clipFromWorld * vec4(t.p1, 1),
                       view.clipFromWorld * vec4(t.p2, 1), ndc);
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const vec3 face = faceNormal(t);
    const float side = dot(face, view.eye - position) < 0 ? -1 : 1;
    const vec3 normal = side * vertexNormal(t, b.at);

    const float sun = sunVisibility(light, shadowMap, position, side * face);
    const vec3 ambient = skyIrradiance(light, normal);
    write(texel, vec4(ambient, sun), mat3(view.viewFromWorld) * normal, b.depth);
}

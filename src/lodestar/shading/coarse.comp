// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../visibility/triangle.glsl"
#include "../visibility/view_params.h"
#include "../upsample/coarse_texel.glsl"
#include "coarse_params.h"
#include "light_visibility.glsl"

// The expensive, smooth terms on grid S, one thread a texel: how much of the sun and of the sky
// seen through the texel's centre sees.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kFullRate = 0;  // 1: S is O, write the terms alone

layout(binding = 6, scalar) uniform View { ViewParams view; };
layout(binding = 7, scalar) uniform Light { LightParams light; };
layout(binding = 8) uniform usampler2D ids;
layout(binding = 9) uniform sampler2DArray sunMap;   // one layer
layout(binding = 10) uniform sampler2DArray skyMaps;  // one a view of the sky
// One binding, of which the constant picks the reading.
layout(binding = 11, rgba32ui) writeonly uniform uimage2D outCoarse;
layout(binding = 11, rgba16f) writeonly uniform image2D outTerms;
layout(push_constant, scalar) uniform Push { CoarseParams params; };

void write(ivec2 texel, vec4 terms, vec3 viewNormal, float depth) {
    if (kFullRate != 0)
        imageStore(outTerms, texel, terms);
    else
        imageStore(outCoarse, texel, packCoarse(terms, viewNormal, depth));
}

float sunVisibility(vec3 position, vec3 faceNormal) {
    if (light.shadowTaps == 0) return 1;
    return lightVisibility(light.views[0], sunMap, 0, int(light.shadowTaps), position, faceNormal);
}

/// Ambient occlusion by depth maps from many directions (Pharr & Green, GPU Gems 2004): the share
/// of the sky's light on the surface that reaches it. Directions behind the surface count a little,
/// so that surfaces that face the ground have an answer.
float skyVisibility(vec3 position, vec3 faceNormal, vec3 normal) {
    if (light.skyViewCount == 0) return 1;
    float seen = 0, all = 0;
    for (int i = 0; i < int(light.skyViewCount); ++i) {
        const vec3 toLight = light.views[i + 1].toLight;
        const float weight = light.views[i + 1].weight * (max(dot(normal, toLight), 0) + 0.05);
        all += weight;
        seen += weight * lightVisibility(light.views[i + 1], skyMaps, i, int(light.skyTaps),
                                         position, faceNormal);
    }
    return seen / all;
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.size)))) return;
    // The triangle is that of the O pixel under the texel's centre; its plane is then met exactly
    // at the centre, so that the grid is regular at any r.
    const vec2 centre = (vec2(texel) + 0.5) * params.rate;
    const vec2 inside = min(centre, vec2(params.fullSize) - 0.5);
    const uint id = texelFetch(ids, ivec2(inside), 0).x;
    if (id == 0) {
        write(texel, vec4(1, 1, 0, 0), vec3(0, 0, 1), 0);
        return;
    }

    const Triangle t = loadTriangle(id);
    Barycentrics b =
        barycentricsAt(view.clipFromWorld * vec4(t.p0, 1), view.clipFromWorld * vec4(t.p1, 1),
                       view.clipFromWorld * vec4(t.p2, 1),
                       inside / vec2(params.fullSize) * 2 - 1);
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const vec3 face = faceNormal(t);
    const float side = dot(face, view.eye - position) < 0 ? -1 : 1;
    const vec3 normal = side * vertexNormal(t, b.at);

    const vec4 terms = vec4(sunVisibility(position, side * face),
                            skyVisibility(position, side * face, normal), 0, 0);
    write(texel, terms, mat3(view.viewFromWorld) * normal, b.depth);
}

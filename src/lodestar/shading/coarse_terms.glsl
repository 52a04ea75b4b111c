// SPDX-License-Identifier: Apache-2.0
// The expensive, smooth terms at a point of a visible surface.
#ifndef LS_COARSE_TERMS_GLSL
#define LS_COARSE_TERMS_GLSL
#include "../shared/noise.h"
#include "../visibility/triangle.glsl"
#include "../visibility/view_params.h"
#include "coarse_params.h"
#include "light_visibility.glsl"

layout(constant_id = 2) const uint kTerms = LS_ALL_TERMS;  // what there is: others are 1

layout(binding = 6, scalar) uniform View { ViewParams view; };
layout(binding = 7, scalar) uniform Light { LightParams light; };
layout(binding = 8) uniform usampler2D ids;
layout(binding = 9) uniform sampler2DArray sunMap;    // one layer
layout(binding = 10) uniform sampler2DArray skyMaps;  // one a view of the sky

struct SurfacePoint {
    vec3 position, faceNormal, normal;  // world; the normals on the side that is seen
    float depth;                        // linear view depth
};

/// Where the ray through `ndc` meets the plane of triangle `id`.
SurfacePoint surfacePoint(uint id, vec2 ndc) {
    const Triangle t = loadTriangle(id);
    const Barycentrics b = barycentricsAt(view.clipFromWorld * vec4(t.p0, 1),
                                          view.clipFromWorld * vec4(t.p1, 1),
                                          view.clipFromWorld * vec4(t.p2, 1), ndc);
    const vec3 position = t.p0 * b.at.x + t.p1 * b.at.y + t.p2 * b.at.z;
    const vec3 face = faceNormal(t);
    const float side = dot(face, view.eye - position) < 0 ? -1 : 1;
    return SurfacePoint(position, side * face, side * vertexNormal(t, b.at), b.depth);
}

float sunVisibility(SurfacePoint at, int taps) {
    if (taps == 0) return 1;
    return lightVisibility(light.views[0], sunMap, 0, taps, at.position, at.faceNormal);
}

/// Ambient occlusion by depth maps from many directions (Pharr & Green, GPU Gems 2004): the share
/// of the sky's light on the surface that reaches it. Directions behind the surface count a little,
/// so that surfaces that face the ground have an answer.
float skyVisibility(SurfacePoint at, int views) {
    if (views == 0) return 1;
    float seen = 0, all = 0;
    for (int i = 0; i < views; ++i) {
        const vec3 toLight = light.views[i + 1].toLight;
        const float weight = light.views[i + 1].weight * (max(dot(at.normal, toLight), 0) + 0.05);
        all += weight;
        seen += weight * lightVisibility(light.views[i + 1], skyMaps, i, int(light.skyTaps),
                                         at.position, at.faceNormal);
    }
    return seen / all;
}

/// A term that is not asked for costs nothing: its loops run no time.
vec4 evaluateTerms(SurfacePoint at, uint asked) {
    const uint terms = asked & kTerms;
    const int taps = (terms & LS_TERM_SHADOW) != 0 ? int(light.shadowTaps) : 0;
    const int views = (terms & LS_TERM_AO) != 0 ? int(light.skyViewCount) : 0;
    const int octaves = (terms & LS_TERM_NOISE) != 0 ? int(light.noiseOctaves) : 0;
    const int warps = octaves > 0 ? int(light.noiseWarps) : 0;
    const float pattern = warpedNoise(at.position * light.noiseFrequency, octaves, warps);
    return vec4(sunVisibility(at, taps), skyVisibility(at, views), 0.5 + 0.5 * pattern, 0);
}

#endif

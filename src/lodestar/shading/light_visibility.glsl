// SPDX-License-Identifier: Apache-2.0
#ifndef LS_LIGHT_VISIBILITY_GLSL
#define LS_LIGHT_VISIBILITY_GLSL
#include "light_params.h"

/// Share of a parallel light a surface point sees: N×N percentage-closer filtering (Reeves et al.
/// 1987) with bilinear edges, so it is continuous in the point, and the exact plane of the receiver
/// as the bias: each texel is compared with the depth that plane has there.
float lightVisibility(GpuLightView view, sampler2DArray maps, int layer, int n, vec3 position,
                      vec3 faceNormal) {
    const vec4 point = vec4(position, 1);
    const vec2 at = vec2(dot(view.u, point), dot(view.v, point));  // texels

    // The plane's depth slope per texel; bounded, since a face almost edge-on to the light gets
    // none of it anyway.
    const float facing = dot(faceNormal, view.toLight);
    const float towards = facing < 0 ? min(facing, -0.05) : max(facing, 0.05);
    const vec2 slope = vec2(dot(faceNormal, view.u.xyz), dot(faceNormal, view.v.xyz)) *
                       (-view.planeScale / towards);

    const vec2 corner = at - 0.5 * float(n);     // of the N×N texel window
    const ivec2 first = ivec2(floor(corner));
    const vec2 over = corner - vec2(first);      // share of the first row and column left out
    if (any(lessThan(first, ivec2(0))) || any(greaterThanEqual(first + n, ivec2(view.size)))) return 1;
    const float start =
        dot(view.depth, point) + dot(slope, vec2(first) + 0.5 - at) + view.bias;

    float lit = 0;
    for (int y = 0; y <= n; ++y) {
        const float row = start + slope.y * float(y);
        float sum = 0;
        for (int x = 0; x <= n; ++x) {
            const float occluder = texelFetch(maps, ivec3(first + ivec2(x, y), layer), 0).x;
            const float weight = x == 0 ? 1 - over.x : x == n ? over.x : 1;
            // Past the scene's far end the plane's depth is negative; an empty texel (0) is not
            // in front of it.
            sum += max(row + slope.x * float(x), 0) >= occluder ? weight : 0;
        }
        lit += sum * (y == 0 ? 1 - over.y : y == n ? over.y : 1);
    }
    return lit / float(n * n);
}

#endif

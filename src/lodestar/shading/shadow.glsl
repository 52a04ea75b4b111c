// SPDX-License-Identifier: Apache-2.0
#ifndef LS_SHADOW_GLSL
#define LS_SHADOW_GLSL
#include "light_params.h"

/// Share of the sun a surface point sees: N×N percentage-closer filtering (Reeves et al. 1987) with
/// bilinear edges, so it is continuous in the point, and the exact plane of the receiver as the
/// bias: each texel is compared with the depth that plane has there.
float sunVisibility(LightParams light, sampler2D shadowMap, vec3 position, vec3 faceNormal) {
    if (light.shadowTaps == 0) return 1;
    const ivec2 size = textureSize(shadowMap, 0);
    const vec3 at = (light.shadowFromWorld * vec4(position, 1)).xyz;  // texels, depth

    // The plane's depth slope per texel, from its normal in the light's axes; bounded, since a face
    // almost edge-on to the sun gets no light anyway.
    const float facing = dot(faceNormal, light.toSun);
    const float towards = facing < 0 ? min(facing, -0.05) : max(facing, 0.05);
    const vec2 slope = -vec2(dot(faceNormal, light.shadowRight), dot(faceNormal, light.shadowUp)) /
                       towards * light.shadowTexel * light.shadowDepthScale;
    const float bias = 1.0 * light.shadowTexel * light.shadowDepthScale;

    const int n = int(light.shadowTaps);
    const vec2 corner = at.xy - 0.5 * float(n);       // of the N×N texel window
    const ivec2 first = ivec2(floor(corner));
    const vec2 over = corner - vec2(first);           // share of the first row and column left out
    if (any(lessThan(first, ivec2(0))) || any(greaterThanEqual(first + n, size))) return 1;
    const float start = at.z + dot(slope, vec2(first) + 0.5 - at.xy) + bias;

    float lit = 0;
    for (int y = 0; y <= n; ++y) {
        const float row = start + slope.y * float(y);
        float sum = 0;
        for (int x = 0; x <= n; ++x) {
            const float occluder = texelFetch(shadowMap, first + ivec2(x, y), 0).x;
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

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/tiles.glsl"
#include "../visibility/view_params.h"
#include "background_params.h"
#include "coarse_params.h"
#include "sky.glsl"

// What the passes over surfaces leave out: one thread a pixel of grid O.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kBackdrop = 0;  // 1: one colour in the place of the sky
layout(constant_id = 1) const uint kTerms = 1;     // 0: `outTerms` is not written

layout(binding = 0, scalar) uniform View { ViewParams view; };
layout(binding = 1, scalar) uniform Light { LightParams light; };
layout(binding = 2) uniform sampler2D sky;
layout(binding = 3, r32f) writeonly uniform image2D outDepth;
layout(binding = 4, rgba16f) writeonly uniform image2D outTerms;
layout(binding = 5, rgba16f) writeonly uniform image2D outRadiance;
layout(binding = 6) uniform usamplerBuffer tiles;
layout(push_constant, scalar) uniform Push { BackgroundParams params; };

void main() {
    const ivec2 pixel = pixelOfThread(tiles);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const vec2 ndc = (vec2(pixel) + 0.5) / vec2(params.size) * 2 - 1;
    const vec3 direction = normalize(rayThrough(view, ndc));
    const vec4 seen =
        kBackdrop != 0 ? pastSurfaces(light.backdrop, light.exposure)
                       : pastSurfaces(skyRadiance(sky, light.skyLevels, direction, 0), direction,
                                      light.toSun, light.sunIlluminance);
    imageStore(outDepth, pixel, vec4(0));
    if (kTerms != 0) imageStore(outTerms, pixel, kTermsOfBackground);
    imageStore(outRadiance, pixel, seen);
}

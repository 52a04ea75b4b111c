// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/color.glsl"
#include "tonemap_params.h"

// Linear radiance to display codes, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D radiance;
layout(binding = 1, rgba8) writeonly uniform image2D display;
layout(push_constant, scalar) uniform Push { TonemapParams params; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, ivec2(params.size)))) return;
    const vec4 texel = texelFetch(radiance, pixel, 0);
    const vec3 exposed = texel.rgb * params.exposure;
    const vec3 shown = mix(clamp(exposed, 0, 1), acesFilmic(exposed), clamp(texel.a, 0, 1));
    imageStore(display, pixel, vec4(srgbFromLinear(shown), 1));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// The picture on grid B, in layers: one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kDownsampled = 0;  // 1: `color` lies on B, with its CoC in w

layout(binding = 0) uniform sampler2D color;      // grid O
layout(binding = 1) uniform sampler2D depth;      // grid O
layout(binding = 2, r32f) writeonly uniform image2D depthB;  // where downsampled
layout(binding = 3, rgba32ui) writeonly uniform uimage2D outLayers;
layout(push_constant, scalar) uniform Push { DofParams params; };

vec2 centreOnO(ivec2 texel) {
    return min((vec2(texel) + 0.5) * params.grid.rate, vec2(params.grid.fullSize) - 0.5);
}

/// The mean of four of the texel's pixels, each in the layer of its own depth: no colour comes over
/// an edge, and the foreground's cover is smooth.
Layers pixelsOf(ivec2 texel) {
    const vec2 centre = centreOnO(texel), last = vec2(params.grid.fullSize) - 1;
    Layers sum = Layers(vec4(0), vec3(0), vec2(0));
    for (int i = 0; i < 4; ++i) {
        // A square on its corner: no two in a row or column.
        const vec2 o = vec2(i == 0 ? -0.125 : i == 1 ? 0.375 : i == 2 ? 0.125 : -0.375,
                            i == 0 ? -0.375 : i == 1 ? -0.125 : i == 2 ? 0.375 : 0.125);
        const ivec2 at = ivec2(clamp(centre + o * params.grid.rate, vec2(0), last));
        const float coc = cocOf(params, texelFetch(depth, at, 0).x);
        add(sum, layersOf(texelFetch(color, at, 0).rgb, coc), 0.25);
    }
    return sum;
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    if (kDownsampled != 0) {
        const vec4 c = texelFetch(color, texel, 0);
        imageStore(depthB, texel, vec4(texelFetch(depth, ivec2(centreOnO(texel)), 0).x));
        imageStore(outLayers, texel, packLayers(layersOf(c.rgb, c.w)));
        return;
    }
    imageStore(outLayers, texel, packLayers(pixelsOf(texel)));
}

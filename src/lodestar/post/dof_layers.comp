// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// The picture on grid B, in layers: one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = 0) const uint kDownsampled = 0;  // 1: `color` lies on B, with its CoC in w

layout(binding = 0) uniform sampler2D color;  // grid O
layout(binding = 1) uniform sampler2D depth;  // grid O
layout(binding = 2, r32f) writeonly uniform image2D outCoc;
layout(binding = 3, rgba32ui) writeonly uniform uimage2D outLayers;
layout(push_constant, scalar) uniform Push { DofParams params; };

/// The mean of the texel's pixels, each in the layer of its own depth: no colour comes over an
/// edge, and the foreground's cover is smooth. All of them, for a highlight may be one pixel.
Layers pixelsOf(ivec2 texel) {
    const vec2 last = vec2(params.grid.fullSize) - 1, first = vec2(texel) * params.grid.rate;
    const ivec2 taps = ivec2(ceil(params.grid.rate - 0.01));
    const vec2 step = params.grid.rate / vec2(taps);
    Layers sum = Layers(vec4(0), vec3(0), vec2(0));
    for (int y = 0; y < taps.y; ++y)
        for (int x = 0; x < taps.x; ++x) {
            const ivec2 at = ivec2(min(first + (vec2(x, y) + 0.5) * step, last));
            const float coc = cocOf(params, texelFetch(depth, at, 0).x);
            add(sum, layersOf(texelFetch(color, at, 0).rgb, coc), 1);
        }
    const float w = 1 / float(taps.x * taps.y);
    return Layers(sum.far * w, sum.near * w, sum.cover * w);
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    const ivec2 centre =
        ivec2(min((vec2(texel) + 0.5) * params.grid.rate, vec2(params.grid.fullSize) - 0.5));
    imageStore(outCoc, texel, vec4(cocOf(params, texelFetch(depth, centre, 0).x)));
    if (kDownsampled != 0) {
        const vec4 c = texelFetch(color, texel, 0);
        imageStore(outLayers, texel, packLayers(layersOf(c.rgb, c.w)));
    } else {
        imageStore(outLayers, texel, packLayers(pixelsOf(texel)));
    }
}

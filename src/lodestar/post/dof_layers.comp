// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// The picture on grid B, in layers: one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

const uint kPixels = 0;       // of O, each by itself
const uint kQuads = 1;        // the same, four at a time: an even number of them a texel
const uint kDownsampled = 2;  // `color` lies on B, with its CoC in w
layout(constant_id = 0) const uint kSource = kPixels;

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

const float kAlike = 1.0 / 32;  // circles of confusion that are one
const float kInset = 0.49;      // of a pixel, to the first of a quad: none but its own are filtered

/// The same, four pixels at a time. Where they are much alike, which is nearly everywhere, each
/// counts by its own depth and has their mean colour, one filtered fetch. Else the first of them
/// stands for all: a mean colour would take focus into the blur.
Layers quadsOf(ivec2 texel) {
    const ivec2 rate = ivec2(params.grid.rate);
    const ivec2 last = ivec2(params.grid.fullSize) - 1;
    const vec2 ofColor = 1 / vec2(textureSize(color, 0)), ofDepth = 1 / vec2(textureSize(depth, 0));
    Layers sum = Layers(vec4(0), vec3(0), vec2(0));
    for (int y = 1; y < rate.y; y += 2)
        for (int x = 1; x < rate.x; x += 2) {
            const vec2 middle = vec2(min(texel * rate + ivec2(x, y), last));
            const vec4 z = textureGather(depth, middle * ofDepth);
            const vec4 coc = vec4(cocOf(params, z.x), cocOf(params, z.y), cocOf(params, z.z),
                                  cocOf(params, z.w));
            const float least = min(min(coc.x, coc.y), min(coc.z, coc.w));
            const float most = max(max(coc.x, coc.y), max(coc.z, coc.w));
            const bool alike = most - least <= kAlike || min(2 * least - most, least) >= 0 ||
                               max(2 * most - least, most) <= 0;
            const vec2 at = alike ? middle : middle - kInset;
            addFour(sum, textureLod(color, at * ofColor, 0).rgb, alike ? coc : coc.wwww);
        }
    const float w = 1 / float(rate.x * rate.y);
    return Layers(sum.far * w, sum.near * w, sum.cover * w);
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    const ivec2 centre =
        ivec2(min((vec2(texel) + 0.5) * params.grid.rate, vec2(params.grid.fullSize) - 0.5));
    imageStore(outCoc, texel, vec4(cocOf(params, texelFetch(depth, centre, 0).x)));
    if (kSource == kDownsampled) {
        const vec4 c = texelFetch(color, texel, 0);
        imageStore(outLayers, texel, packLayers(layersOf(c.rgb, c.w)));
    } else {
        imageStore(outLayers, texel,
                   packLayers(kSource == kQuads ? quadsOf(texel) : pixelsOf(texel)));
    }
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// One axis of a Gaussian, one thread a texel that is written.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform usampler2D layers;
layout(binding = 1, rgba32ui) writeonly uniform uimage2D outLayers;
layout(push_constant, scalar) uniform Push { DofBlurParams params; };

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.size)))) return;
    const ivec2 axis = ivec2(params.axis), last = ivec2(params.fromSize) - 1;
    const ivec2 first = texel * (1 + axis * (int(params.step) - 1));
    const float middle = 0.5 * float(params.step - 1);
    Layers sum = Layers(vec4(0), vec3(0), vec2(0));
    float weights = 0;
    for (int i = -int(params.reach); i < int(params.reach + params.step); ++i) {
        const float d = float(i) - middle;
        const float w = exp2(-params.falloff * d * d);
        add(sum, unpackLayers(texelFetch(layers, clamp(first + i * axis, ivec2(0), last), 0)), w);
        weights += w;
    }
    const float scale = 1 / weights;
    imageStore(outLayers, texel,
               packLayers(Layers(sum.far * scale, sum.near * scale, sum.cover * scale)));
}

// SPDX-License-Identifier: Apache-2.0
#version 460
#include "dof.glsl"

// From three blurred pictures the one that each texel of B shows, one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D cocs;  // grid B
layout(binding = 1) uniform usampler2D small;
layout(binding = 2) uniform usampler2D middle;
layout(binding = 3) uniform usampler2D largest;
layout(binding = 4, rgba32ui) writeonly uniform uimage2D outBlurred;  // see dof_combine.comp
layout(push_constant, scalar) uniform Push { DofParams params; };

Layers bilinear(usampler2D layers, ivec2 texel, uvec2 step) {
    const vec2 at = (vec2(texel) + 0.5) / vec2(step) - 0.5, base = floor(at), f = at - base;
    const ivec2 last = ivec2((params.grid.size + step - 1) / step) - 1;
    Layers sum = Layers(vec4(0), vec3(0), vec2(0));
    const int taps = any(greaterThan(step, uvec2(1))) ? 4 : 1;  // of one size with B it is the texel
    for (int i = 0; i < taps; ++i) {
        const ivec2 o = ivec2(i & 1, i >> 1);
        const ivec2 tap = clamp(ivec2(base) + o, ivec2(0), last);
        add(sum, unpackLayers(texelFetch(layers, tap, 0)),
            (o.x == 0 ? 1 - f.x : f.x) * (o.y == 0 ? 1 - f.y : f.y));
    }
    return sum;
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    const Layers a = bilinear(small, texel, uvec2(params.stepsX.x, params.stepsY.x)),
                 b = bilinear(middle, texel, uvec2(params.stepsX.y, params.stepsY.y)),
                 c = bilinear(largest, texel, uvec2(params.stepsX.z, params.stepsY.z));

    // Between the three by the circle of confusion: from sharp to the first, dof_combine goes. The
    // foreground's is the mean of that around, since it blurs over its edge; behind it, what is
    // around reaches in the farthest by the largest blur.
    const float coc = texelFetch(cocs, texel, 0).x;
    const float far = coc < 0 ? 2 : max(3 * coc - 1, 0);
    const vec3 af = a.far.rgb / a.far.w, bf = b.far.rgb / b.far.w, cf = c.far.rgb / c.far.w;
    const vec3 behind = far < 1 ? mix(af, bf, far) : mix(bf, cf, far - 1);
    const float near = clamp(3 * c.cover.y / max(c.cover.x, 1e-3) - 1, 0, 2);
    const vec4 n = near < 1 ? mix(vec4(a.near, a.cover.x), vec4(b.near, b.cover.x), near)
                            : mix(vec4(b.near, b.cover.x), vec4(c.near, c.cover.x), near - 1);
    imageStore(outBlurred, texel,
               uvec4(packHalf2x16(behind.rg), packHalf2x16(vec2(behind.b, guideOf(coc))),
                     packHalf2x16(n.rg), packHalf2x16(n.ba)));
}

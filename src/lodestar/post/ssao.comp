// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../shared/octahedral.h"
#include "../upsample/coarse_texel.glsl"
#include "../visibility/view_params.h"
#include "ssao_params.h"

// Ambient occlusion from depth and normals of grid B alone, one thread a texel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, scalar) uniform View { ViewParams view; };
layout(binding = 1) uniform sampler2D depth;
layout(binding = 2) uniform usampler2D normal;
layout(binding = 3, rgba32ui) writeonly uniform uimage2D outOcclusion;  // packCoarse, in w
layout(push_constant, scalar) uniform Push { SsaoParams params; };

#include "effective.glsl"

/// The mean over points of the hemisphere about C of
///     clamp(N·V / |V| − bias, 0, 1) · clamp(1 − V·V / R², 0, 1),      V = P − C,
/// P being the surface that is seen where the point is (thesis, eq. 5, with V turned around).
float occlusionAt(ivec2 texel, vec3 c, vec3 n) {
    // A frame about the normal (Duff et al. 2017).
    const float side = n.z >= 0 ? 1.0 : -1.0;
    const float a = -1 / (side + n.z), b = n.x * n.y * a;
    const vec3 t = vec3(1 + side * n.x * n.x * a, side * b, -side * n.x);
    const vec3 u = vec3(b, side + n.y * n.y * a, -n.y);
    // Nine turns of the same points, one for each texel of 3 × 3: their mean is taken afterwards.
    const int which = (texel.x % 3 + texel.y % 3 * 3) * 4 % 9;
    const float angle = float(which) * (2 * 3.14159265 / 9);
    vec2 around = vec2(cos(angle), sin(angle));
    float sum = 0, inside = 0;
    for (uint i = 0; i < params.samples; ++i) {
        const float height = 1 - (float(i) + 0.5) / float(params.samples);
        const float wide = sqrt(1 - height * height);
        const float far = params.radius * fract((float(i) + 0.5) * LS_GOLDEN_RATIO +
                                                float(which) / 9);
        const vec3 s = c + far * (wide * (around.x * t + around.y * u) + height * n);
        around = vec2(around.x * LS_GOLDEN_COS - around.y * LS_GOLDEN_SIN,
                      around.x * LS_GOLDEN_SIN + around.y * LS_GOLDEN_COS);
        // Points behind the eye or beside the picture say nothing.
        const vec2 ndc = s.xy * view.clipScale / max(-s.z, 1e-6) + view.jitter;
        if (s.z >= 0 || any(greaterThanEqual(abs(ndc), vec2(1)))) continue;
        const ivec2 at = clampToB(
            ivec2((ndc * 0.5 + 0.5) * vec2(params.grid.fullSize) / params.grid.rate));
        const float z = texelFetch(depth, at, 0).x;
        ++inside;
        // The texel's own surface lies in the plane: V is nought there but for rounding.
        if (z <= 0 || at == texel) continue;
        const vec3 v = viewPoint(at, z) - c;
        const float d2 = dot(v, v);
        sum += clamp(dot(n, v) * inversesqrt(max(d2, 1e-30)) - params.bias, 0, 1) *
               clamp(1 - d2 / (params.radius * params.radius), 0, 1);
    }
    return sum / max(inside, 1);
}

void main() {
    const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, ivec2(params.grid.size)))) return;
    const float z = texelFetch(depth, texel, 0).x;
    if (z <= 0) {
        imageStore(outOcclusion, texel, packCoarse(vec4(0), vec3(0, 0, 1), 0));
        return;
    }
    const vec3 n = unpackNormal(texelFetch(normal, texel, 0).x);
    const float occlusion = occlusionAt(texel, viewPoint(texel, z), n);
    imageStore(outOcclusion, texel, packCoarse(vec4(0, 0, 0, occlusion), n, z));
}

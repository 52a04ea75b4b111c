// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_GOOGLE_include_directive : require
#include "deferred_params.h"
#include <lodestar/shared/octahedral.h>
#include "phong.glsl"

// The reference renderer's shading: from its G-buffer, one thread a pixel.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D depth;
layout(binding = 1) uniform sampler2D albedo;
layout(binding = 2) uniform usampler2D normal;
layout(binding = 3, rgba8) writeonly uniform image2D outColor;
layout(push_constant, scalar) uniform Push { PhongParams params; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    const ivec2 size = textureSize(depth, 0);
    if (any(greaterThanEqual(pixel, size))) return;
    const float z = texelFetch(depth, pixel, 0).x;
    if (z == 0) {
        imageStore(outColor, pixel, kBackground);
        return;
    }
    // The eye from the pixel, by the rows of world from clip that matter: solve for the point.
    const vec2 ndc = (vec2(pixel) + 0.5) / vec2(size) * 2 - 1;
    const mat4 m = transpose(params.clipFromWorld);  // rows of clip from world
    // x and y of clip space are ndc·z: three planes through the point.
    const mat3 a = mat3(m[0].xyz - ndc.x * m[3].xyz, m[1].xyz - ndc.y * m[3].xyz, m[3].xyz);
    const vec3 ray = normalize(cross(a[0], a[1]));
    const vec3 toEye = dot(ray, a[2]) > 0 ? -ray : ray;
    const vec3 root = texelFetch(albedo, pixel, 0).rgb;
    imageStore(outColor, pixel,
               phong(root * root, unpackNormal(texelFetch(normal, pixel, 0).x), toEye));
}

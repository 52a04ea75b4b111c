// SPDX-License-Identifier: Apache-2.0
#version 460
#include "../scene/scene.glsl"
#include "show_lods_params.h"

// Tints the picture by the level of detail of what each pixel shows: red, green and blue for 0, 1 and
// 2, as in Rakos 2010, then a ramp from yellow to white; what is finer than its mesh in magenta.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 6) uniform usampler2D ids;
layout(binding = 7, rgba8) uniform image2D picture;

layout(push_constant, scalar) uniform Push { ShowLodsParams params; };

vec3 colorOf(uint lod) {
    const vec3 first[3] = vec3[](vec3(1, 0.1, 0.1), vec3(0.1, 1, 0.1), vec3(0.15, 0.25, 1));
    if (lod < 3) return first[lod];
    if (lod == LS_LOD_REFINED) return vec3(1, 0.2, 1);
    const float t = float(lod - 3) / float(LS_MAX_LODS - 4);
    return mix(vec3(1, 0.9, 0.1), vec3(1), t);
}

void main() {
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(picture)))) return;
    const uint id = texelFetch(ids, ivec2((vec2(at) + 0.5) * params.scale), 0).x;
    if (id == 0) return;
    const vec3 shown = imageLoad(picture, at).rgb;
    const float light = dot(shown, vec3(0.2126, 0.7152, 0.0722));
    const vec3 tint = colorOf(loadCluster(id >> LS_TRIANGLE_BITS).lod);
    imageStore(picture, at, vec4(tint * (0.25 + 0.75 * light), 1));
}

// SPDX-License-Identifier: Apache-2.0
// One sun, a sky of two colours, Blinn's highlight: shading as cheap as the thesis's, so that what
// it is fed from shows.
#ifndef LS_PHONG_GLSL
#define LS_PHONG_GLSL

vec4 phong(vec3 albedo, vec3 normal, vec3 toEye) {
    const vec3 toSun = vec3(0.503, 0.805, 0.352), sun = vec3(2.4, 2.3, 2.1);
    const vec3 sky = mix(vec3(0.25, 0.23, 0.2), vec3(0.45, 0.55, 0.7), normal.y * 0.5 + 0.5);
    const float lambert = max(dot(normal, toSun), 0);
    const float highlight =
        lambert > 0 ? pow(max(dot(normal, normalize(toEye + toSun)), 0), 32) * 0.2 : 0;
    const vec3 c = albedo * (sky + sun * lambert * 0.5) + sun * highlight;
    return vec4(sqrt(clamp(c / (1 + 0.5 * c), 0, 1)), 1);
}

const vec4 kBackground = vec4(0.45, 0.55, 0.7, 1);

#endif

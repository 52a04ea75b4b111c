// SPDX-License-Identifier: Apache-2.0
// The alpha test at a point of a triangle, with texture gradients in closed form. The includer has
// included triangle.glsl and material.glsl, and bound `secondUvs`.
#ifndef LS_ALPHA_GLSL
#define LS_ALPHA_GLSL

vec2 mixed(vec2 a, vec2 b, vec2 c, vec3 weights) {
    return a * weights.x + b * weights.y + c * weights.z;
}

/// `toMip`: the distance, in NDC, that decides the mip level: between samples, or less.
bool passesAlpha(Triangle t, vec4 clip0, vec4 clip1, vec4 clip2, vec2 ndc, vec2 toMip,
                 uint baseColorArrays) {
    const Barycentrics b = barycentricsAt(clip0, clip1, clip2, ndc);
    const vec3 dx = b.dx * toMip.x, dy = b.dy * toMip.y;
    const GpuVertexAttributes a0 = loadAttributes(t.vertices.x), a1 = loadAttributes(t.vertices.y),
                              a2 = loadAttributes(t.vertices.z);
    TexturePlace place;
    place.material = t.material;
    place.set0 = TexturePoint(mixed(a0.uv, a1.uv, a2.uv, b.at), mixed(a0.uv, a1.uv, a2.uv, dx),
                              mixed(a0.uv, a1.uv, a2.uv, dy));
    if (kUvTransforms != 0) {
        const vec2 u0 = texelFetch(secondUvs, int(t.vertices.x)).xy,
                   u1 = texelFetch(secondUvs, int(t.vertices.y)).xy,
                   u2 = texelFetch(secondUvs, int(t.vertices.z)).xy;
        place.set1 =
            TexturePoint(mixed(u0, u1, u2, b.at), mixed(u0, u1, u2, dx), mixed(u0, u1, u2, dy));
    }
    const GpuMaterial material = loadMaterial(t.material);
    const vec3 alphas = vec3(unpackUnorm4x8(a0.color).a, unpackUnorm4x8(a1.color).a,
                             unpackUnorm4x8(a2.color).a);
    const float alpha = sampleTexture(material.baseColorTexture, 0, place, baseColorArrays).a *
                        material.baseColor.a * dot(alphas, b.at);
    return alpha >= material.alphaCutoff;
}

#endif

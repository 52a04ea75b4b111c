// SPDX-License-Identifier: Apache-2.0
// Is a sphere in view? Include after declaring `params` (CullParams) and, for hiddenBehind,
// `pyramid` (a samplerBuffer of the Hi-Z levels).
#ifndef LS_CULL_TEST_GLSL
#define LS_CULL_TEST_GLSL

bool inFrustum(vec3 centre, float radius) {
    bool inside = true;
    for (int i = 0; i < 5; ++i)
        inside = inside && dot(params.planes[i], vec4(centre, 1)) >= -radius;
    return inside;
}

#ifdef LS_WITH_HIZ
/// Least and greatest of (row · p) / (w · p) over the sphere, which lies in front of the eye: the
/// planes row − t·w that touch it. |row − t·w| r = dist is a quadratic in t; its discriminant is
/// written so that far, small spheres do not cancel out.
vec2 rangeOver(vec4 row, vec4 w, vec3 centre, float radius) {
    const float a = dot(row, vec4(centre, 1)), b = dot(w, vec4(centre, 1));
    const vec3 across = a * w.xyz - b * row.xyz, turn = cross(row.xyz, w.xyz);
    const float r2 = radius * radius;
    const float root = radius * sqrt(max(dot(across, across) - r2 * dot(turn, turn), 0));
    const float scale = 1 / (b * b - r2 * dot(w.xyz, w.xyz));
    const float middle = a * b - r2 * dot(row.xyz, w.xyz);
    return vec2(middle - root, middle + root) * scale;
}

/// Whether all of the sphere that is in the pyramid's picture lies behind what that shows, at every
/// pixel it could cover. False beside the picture and around its eye.
bool hiddenBehind(mat4 hizFromWorld, vec3 centre, float radius) {
    const mat4 rows = transpose(hizFromWorld);
    const float w = dot(rows[3], vec4(centre, 1));
    if (w <= radius * length(rows[3].xyz) * 1.001) return false;
    const vec2 x = rangeOver(rows[0], rows[3], centre, radius);
    const vec2 y = rangeOver(rows[1], rows[3], centre, radius);
    const float nearest = rangeOver(rows[2], rows[3], centre, radius).y * (1 + 1e-4);
    // A little more to each side: for rounding, and for where a rasteriser snaps vertices to, which is
    // at most 1/16 of a pixel that is twice as wide.
    const float margin = 0.25;
    const vec2 low = max((vec2(x.x, y.x) * 0.5 + 0.5) * params.hizSize - margin, vec2(0));
    const vec2 high =
        min((vec2(x.y, y.y) * 0.5 + 0.5) * params.hizSize + margin, params.hizSize - 1);
    if (any(greaterThan(low, high))) return false;  // beside the picture

    // The level at which the rectangle meets at most 5×5 texels: fewer reach further beyond it.
    const vec2 extent = high - low;
    const int level = clamp(int(ceil(log2(max(extent.x, extent.y) / 4))), int(LS_HIZ_FIRST),
                            int(params.hizLevels) - 1);
    const ivec2 first = ivec2(low) >> level, last = ivec2(high) >> level;
    if (any(greaterThan(last - first, ivec2(4)))) return false;
    const int width = (int(params.hizSize.x) + (1 << level) - 1) >> level;
    const int at = int(params.hizOffsets[level]);
    float farthest = nearest + 1;
    for (int row = first.y; row <= last.y; ++row)
        for (int column = first.x; column <= last.x; ++column)
            farthest = min(farthest, texelFetch(pyramid, at + row * width + column).x);
    return nearest < farthest;
}
#endif

#endif

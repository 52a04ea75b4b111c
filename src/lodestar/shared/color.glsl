// SPDX-License-Identifier: Apache-2.0
#ifndef LS_COLOR_GLSL
#define LS_COLOR_GLSL

/// IEC 61966-2-1 encoding of linear values in [0, 1].
vec3 srgbFromLinear(vec3 c) {
    return mix(1.055 * pow(c, vec3(1 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308)));
}

/// The ACES reference and sRGB output transforms in the rational fit of Stephen Hill: linear sRGB in,
/// linear sRGB in [0, 1] out. Scaled so that 0.18 stays about 0.18.
vec3 acesFilmic(vec3 c) {
    const mat3 in_ = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566,
                          0.83777);
    const mat3 out_ = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367,
                           -0.00605, 1.07602);
    const vec3 v = in_ * (c / 0.6);
    const vec3 fit = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    return clamp(out_ * fit, 0, 1);
}

#endif

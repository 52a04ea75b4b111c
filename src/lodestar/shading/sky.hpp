// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <glm/glm.hpp>

namespace lodestar::shading {

/// A clear sky over a plain, made from the direction to the sun: single scattering by air
/// (Rayleigh), haze (Mie) and ozone absorption along the view ray (Nishita et al. 1993). Free of
/// Vulkan.
class Sky {
public:
    static constexpr float kSunIlluminance = 3.5f;  ///< of a surface facing the sun

    /// `toSun`: unit, world, y up. Sun and sky are scaled together so that a surface facing the sun
    /// gets about an illuminance of kSunIlluminance (a white one then sends out a radiance of
    /// about 1.1).
    explicit Sky(glm::vec3 toSun);

    glm::vec3 toSun() const { return sunDirection; }
    /// At normal incidence on the ground, linear rgb. 0 for a sun below the horizon.
    glm::vec3 sunIlluminance() const { return sunOnGround; }
    /// Without the sun's disc, linear rgb.
    glm::vec3 radiance(glm::vec3 direction) const;

    /// Irradiance by surface normal (x, y, z) as the nine polynomials of skyIrradiance() in
    /// sky.glsl: basis constants and cosine lobe multiplied in (Ramamoorthi & Hanrahan 2001).
    std::array<glm::vec3, 9> irradiance() const;

private:
    glm::vec3 scattered(glm::vec3 direction) const;

    glm::vec3 sunDirection, sunOnGround{0}, ground{0};
    float brightness = 1;
};

/// The irradiance polynomials of any environment, integrated over 2048 cells of equal area.
std::array<glm::vec3, 9> irradianceOf(const std::function<glm::vec3(glm::vec3)>& radiance);

/// Radiance by direction: octahedral, straight up in the middle. Level 0 is the sky itself; level l
/// is blurred by the GGX lobe of roughness l / (levels − 1).
struct SkyMap {
    static constexpr int kSize = 128, kLevels = 5;
    std::array<std::vector<glm::vec4>, kLevels> levels;  ///< (kSize >> l)² texels, rows from v = 0
};
SkyMap makeSkyMap(const Sky&);

}  // namespace lodestar::shading

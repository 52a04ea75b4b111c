// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/sky.hpp>

#include <algorithm>
#include <cmath>

#include <glm/gtc/constants.hpp>

#include <lodestar/shared/octahedral.h>

namespace lodestar::shading {
namespace {

using glm::vec3;

constexpr float kPi = 3.14159265f;

// Earth's atmosphere, lengths in km.
constexpr float kPlanet = 6360, kTop = 6420;
constexpr float kRayleighHeight = 8, kMieHeight = 1.2f, kMieAsymmetry = 0.76f;
const vec3 kRayleigh{5.802e-3f, 13.558e-3f, 33.1e-3f};
const vec3 kMieScatter{4e-3f};
const vec3 kMieExtinct{4.44e-3f};
const vec3 kOzone{0.650e-3f, 1.881e-3f, 0.085e-3f};
// What single scattering leaves out: more light of the same colour, and a whiter part from all
// sides (share of the sun's light on the ground). Chosen so that a clear sky lights a level plane
// with about a fifth of what the sun does.
constexpr float kHigherOrders = 1.7f, kFromAllSides = 0.022f;
const vec3 kGroundAlbedo{0.22f, 0.20f, 0.17f};

float exitDistance(vec3 from, vec3 direction) {
    const float b = glm::dot(from, direction);
    return -b + std::sqrt(std::max(0.0f, b * b - glm::dot(from, from) + kTop * kTop));
}

struct Density {
    float rayleigh, mie, ozone;
};

Density densityAt(vec3 point) {
    const float height = std::max(0.0f, glm::length(point) - kPlanet);
    return {std::exp(-height / kRayleighHeight), std::exp(-height / kMieHeight),
            std::max(0.0f, 1 - std::abs(height - 25) / 15)};
}

vec3 extinction(Density d) {
    return kRayleigh * d.rayleigh + kMieExtinct * d.mie + kOzone * d.ozone;
}

vec3 transmittance(vec3 from, vec3 direction, float length, int steps) {
    vec3 depth{0};
    for (int i = 0; i < steps; ++i)
        depth += extinction(densityAt(from + direction * (length * (static_cast<float>(i) + 0.5f) /
                                                          static_cast<float>(steps))));
    return glm::exp(-depth * (length / static_cast<float>(steps)));
}

const vec3 kEye{0, kPlanet + 0.2f, 0};

vec3 directionOf(float u, float v) {
    const vec3 d = shared::octahedralDecode({2 * u - 1, 2 * v - 1});
    return {d.x, d.z, d.y};
}

/// Calls `f(direction, solid angle)` over the sphere in equal-area cells.
template <typename F>
void overSphere(F&& f) {
    constexpr int kRows = 32, kColumns = 64;
    for (int i = 0; i < kRows; ++i)
        for (int j = 0; j < kColumns; ++j) {
            const float y = 1 - 2 * (static_cast<float>(i) + 0.5f) / kRows;
            const float phi = 2 * kPi * (static_cast<float>(j) + 0.5f) / kColumns;
            const float s = std::sqrt(1 - y * y);
            f(vec3(s * std::cos(phi), y, s * std::sin(phi)), 4 * kPi / (kRows * kColumns));
        }
}

}  // namespace

Sky::Sky(vec3 toSun) : sunDirection(glm::normalize(toSun)) {
    const bool up = sunDirection.y > 0;
    const vec3 through =
        transmittance(kEye, sunDirection, exitDistance(kEye, sunDirection), 32) * float(up);
    const float luminance = glm::dot(through, vec3(0.2126f, 0.7152f, 0.0722f));
    brightness = up ? kSunIlluminance / std::max(luminance, 0.05f) : kSunIlluminance;
    sunOnGround = through * brightness;

    vec3 fromSky{0};
    overSphere([&](vec3 d, float solidAngle) {
        if (d.y > 0) fromSky += scattered(d) * d.y * solidAngle;
    });
    ground = kGroundAlbedo / kPi * (sunOnGround * std::max(sunDirection.y, 0.0f) + fromSky);
}

vec3 Sky::scattered(vec3 direction) const {
    constexpr int kSteps = 16, kSunSteps = 6;
    const float length = exitDistance(kEye, direction);
    const float cosine = glm::dot(direction, sunDirection);
    constexpr float g = kMieAsymmetry;
    const float rayleighPhase = 3 / (16 * kPi) * (1 + cosine * cosine);
    const float miePhase = 3 / (8 * kPi) * (1 - g * g) * (1 + cosine * cosine) /
                           ((2 + g * g) * std::pow(1 + g * g - 2 * g * cosine, 1.5f));
    vec3 sum{0}, depth{0};
    float before = 0;
    for (int i = 0; i < kSteps; ++i) {
        // Steps grow with distance: most of the air is near.
        const float t = static_cast<float>(i + 1) / kSteps;
        const float after = length * t * t;
        const float step = after - before;
        const vec3 point = kEye + direction * (before + 0.5f * step);
        before = after;
        const Density d = densityAt(point);
        depth += extinction(d) * (0.5f * step);
        const vec3 sun =
            transmittance(point, sunDirection, exitDistance(point, sunDirection), kSunSteps);
        sum += glm::exp(-depth) * sun * step *
               (kRayleigh * (d.rayleigh * rayleighPhase) + kMieScatter * (d.mie * miePhase));
        depth += extinction(d) * (0.5f * step);
    }
    return sum * (brightness * kHigherOrders) +
           sunOnGround * (kFromAllSides * std::max(sunDirection.y, 0.0f));
}

vec3 Sky::radiance(vec3 direction) const {
    if (direction.y >= 0.01f) return scattered(direction);
    // Towards the ground, through a band of haze at the horizon.
    const vec3 horizon = scattered(glm::normalize(vec3(direction.x, 0.01f, direction.z)));
    return glm::mix(horizon, ground, glm::smoothstep(0.0f, 0.12f, -direction.y));
}

std::array<vec3, 9> Sky::irradiance() const {
    return irradianceOf([this](vec3 d) { return radiance(d); });
}

std::array<vec3, 9> irradianceOf(const std::function<vec3(vec3)>& radiance) {
    std::array<vec3, 9> sh{};
    overSphere([&](vec3 d, float solidAngle) {
        const vec3 light = radiance(d) * solidAngle;
        const float basis[9] = {1,
                                d.y,
                                d.z,
                                d.x,
                                d.x * d.y,
                                d.y * d.z,
                                3 * d.z * d.z - 1,
                                d.x * d.z,
                                d.x * d.x - d.y * d.y};
        for (int i = 0; i < 9; ++i) sh[i] += light * basis[i];
    });
    // Basis constants squared (projection and evaluation) times the cosine lobe of each band.
    constexpr float k0 = 0.282095f, k1 = 0.488603f, k2 = 1.092548f, k20 = 0.315392f,
                    k22 = 0.546274f;
    constexpr float a0 = kPi, a1 = 2 * kPi / 3, a2 = kPi / 4;
    constexpr float scale[9] = {k0 * k0 * a0,   k1 * k1 * a1, k1 * k1 * a1,
                                k1 * k1 * a1,   k2 * k2 * a2, k2 * k2 * a2,
                                k20 * k20 * a2, k2 * k2 * a2, k22 * k22 * a2};
    for (int i = 0; i < 9; ++i) sh[i] *= scale[i];
    return sh;
}

SkyMap makeSkyMap(const Sky& sky) {
    SkyMap map;
    constexpr int n = SkyMap::kSize;
    auto& sharp = map.levels[0];
    sharp.resize(std::size_t(n) * n);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            sharp[std::size_t(y) * n + x] =
                glm::vec4(sky.radiance(directionOf((static_cast<float>(x) + 0.5f) / n,
                                                   (static_cast<float>(y) + 0.5f) / n)),
                          1);

    const auto lookUp = [&](vec3 d) {
        const glm::vec2 e = shared::octahedralEncode({d.x, d.z, d.y});
        const int x = std::clamp(int((e.x * 0.5f + 0.5f) * n), 0, n - 1);
        const int y = std::clamp(int((e.y * 0.5f + 0.5f) * n), 0, n - 1);
        return vec3(sharp[std::size_t(y) * n + x]);
    };
    constexpr int kSamples = 128;
    for (int level = 1; level < SkyMap::kLevels; ++level) {
        const int size = n >> level;
        const float roughness = static_cast<float>(level) / (SkyMap::kLevels - 1);
        const float alpha = roughness * roughness;
        auto& texels = map.levels[std::size_t(level)];
        texels.resize(std::size_t(size) * size);
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                // Normal = eye = reflection, as split-sum environment maps assume (Karis 2013).
                const vec3 normal =
                    directionOf((static_cast<float>(x) + 0.5f) / static_cast<float>(size),
                                (static_cast<float>(y) + 0.5f) / static_cast<float>(size));
                const vec3 side = glm::normalize(
                    glm::cross(std::abs(normal.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0), normal));
                const vec3 across = glm::cross(normal, side);
                vec3 sum{0};
                float weights = 0;
                for (int i = 0; i < kSamples; ++i) {
                    const float u = (static_cast<float>(i) + 0.5f) / kSamples;
                    const float phi = 2 * kPi * 0.61803399f * static_cast<float>(i);
                    const float cosine = std::sqrt((1 - u) / (1 + (alpha * alpha - 1) * u));
                    const float sine = std::sqrt(1 - cosine * cosine);
                    const vec3 half = side * (sine * std::cos(phi)) +
                                      across * (sine * std::sin(phi)) + normal * cosine;
                    const vec3 light = 2 * glm::dot(normal, half) * half - normal;
                    const float weight = glm::dot(normal, light);
                    if (weight <= 0) continue;
                    sum += lookUp(light) * weight;
                    weights += weight;
                }
                texels[std::size_t(y) * std::size_t(size) + std::size_t(x)] =
                    glm::vec4(sum / std::max(weights, 1e-6f), 1);
            }
    }
    return map;
}

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <glm/gtc/packing.hpp>

#include <lodestar/shared/octahedral.h>
#include <lodestar/upsample/upsample_reference.hpp>

/// Inputs of the upsampling tests, rounded as the GPU's formats round them.
namespace lodestar::upsample {

inline constexpr std::array kAllKinds{Reconstruct::nearestDepth, Reconstruct::bilateral,
                                      Reconstruct::bilinear,     Reconstruct::biquadratic,
                                      Reconstruct::bicubic,      Reconstruct::gaussian,
                                      Reconstruct::nearest};
inline constexpr std::array kRates{1.0f, 1.37f, 2.0f, 3.5f, 7.3f};
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// The name of a kind, for failure messages.
inline const char* nameOf(Reconstruct kind) {
    return kReconstructNames[static_cast<std::size_t>(kind)].data();
}

struct Surfel {
    glm::dvec4 terms{0};
    double depth = 1;
    glm::dvec3 normal{0, 0, 1};
};

/// Grids S and O over the same picture.
struct Grids {
    glm::ivec2 coarseSize{1}, fullSize{1};
    double rate = 1;
    std::vector<ReferenceTexel> coarse;
    std::vector<ReferencePixel> pixels;

    /// Samples `at` (O pixels, real) at the centres of the texels of S and of O.
    Grids(glm::ivec2 size, float r, const std::function<Surfel(glm::dvec2)>& at)
        : coarseSize(int(std::ceil(float(size.x) / r)), int(std::ceil(float(size.y) / r))),
          fullSize(size),
          rate(r) {
        for (int y = 0; y < coarseSize.y; ++y)
            for (int x = 0; x < coarseSize.x; ++x) {
                const Surfel s = at(rate * glm::dvec2(x + 0.5, y + 0.5));
                const glm::dvec2 n = foreshortened(s.normal);
                coarse.push_back({half(s.terms), float(s.depth), glm::dvec2(half({n, 0, 0}))});
            }
        for (int y = 0; y < fullSize.y; ++y)
            for (int x = 0; x < fullSize.x; ++x) {
                const Surfel s = at({x + 0.5, y + 0.5});
                const auto bits = shared::packNormal(glm::vec3(s.normal));
                pixels.push_back({float(s.depth), glm::dvec3(shared::unpackNormal(bits))});
            }
    }

    std::vector<glm::dvec4> reference(Reconstruct kind, const Sigmas& sigmas) const {
        return upsampleReference(kind, sigmas, {coarse, pixels, coarseSize, fullSize, rate});
    }
    std::size_t indexOf(int x, int y) const { return std::size_t(y * fullSize.x + x); }

private:
    static glm::dvec4 half(glm::dvec4 v) {
        return glm::dvec4(glm::unpackHalf4x16(glm::packHalf4x16(glm::vec4(v))));
    }
};

/// Unrelated terms, depths and normals everywhere.
inline Grids noise(glm::ivec2 size, float rate, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    return {size, rate, [&](glm::dvec2) -> Surfel {
                const double phi = 6.2831853 * unit(random), tilt = 1.2 * unit(random);
                return {glm::dvec4(unit(random), unit(random), unit(random), unit(random)),
                        5 + 0.3 * unit(random),
                        {std::sin(tilt) * std::cos(phi), std::sin(tilt) * std::sin(phi),
                         std::cos(tilt)}};
            }};
}

/// Two walls that meet at a column of O: terms 0 and depth 2 left of it, terms 1 and depth 3 right.
inline Grids depthEdge(glm::ivec2 size, float rate, double column) {
    return {size, rate, [&](glm::dvec2 at) -> Surfel {
                const bool right = at.x > column;
                return {glm::dvec4(right ? 1 : 0), right ? 3.0 : 2.0, {0, 0, 1}};
            }};
}

}  // namespace lodestar::upsample

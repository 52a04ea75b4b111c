// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <lodestar/shading/light_views.hpp>
#include <lodestar/shading/light_visibility_reference.hpp>

/// Shadow maps of a few quads, made without a GPU, for the tests of the shadow term.
namespace lodestar::shading {

struct Quad {
    glm::dvec3 corner, alongA, alongB;
};

/// A floor at y = 0 of half-size `half`.
inline Quad floorQuad(double half) {
    return {{-half, 0, -half}, {0, 0, 2 * half}, {2 * half, 0, 0}};
}

/// What a test of the shadow term needs: the sun's view of a scene and its map.
struct ShadowScene {
    static constexpr int kSize = 128;
    LightView sun;
    int taps;
    std::vector<float> depth;

    ShadowScene(glm::vec3 toSun, int tapCount, const std::vector<Quad>& quads) : taps(tapCount) {
        scene::Bounds bounds;
        for (const Quad& q : quads)
            for (const glm::dvec3& p : {q.corner, q.corner + q.alongA, q.corner + q.alongB,
                                        q.corner + q.alongA + q.alongB})
                bounds.add(glm::vec3(p));
        sun = fitSun(toSun, bounds, {}, 1, 1e6f, kSize);
        const glm::dmat4 world = glm::inverse(glm::dmat4(sun.mapFromWorld));
        for (int v = 0; v < kSize; ++v)
            for (int u = 0; u < kSize; ++u) {
                double nearest = 0;
                for (const Quad& q : quads)
                    nearest = std::max(nearest, depthOf(q, world, {u + 0.5, v + 0.5}));
                depth.push_back(static_cast<float>(nearest));
            }
    }

    double visibility(glm::dvec3 position, glm::dvec3 normal) const {
        return lightVisibilityReference(sun.params(), {depth, kSize, kSize}, taps, position,
                                        normal);
    }

private:
    /// Depth at which the sun's ray through a point of the map meets the quad; 0 where it does not.
    static double depthOf(const Quad& q, const glm::dmat4& worldFromShadow, glm::dvec2 at) {
        const glm::dvec3 start(worldFromShadow * glm::dvec4(at, 0, 1));
        const glm::dvec3 perDepth(worldFromShadow * glm::dvec4(0, 0, 1, 0));
        const glm::dvec3 normal = glm::cross(q.alongA, q.alongB);
        const double across = glm::dot(normal, perDepth);
        if (std::abs(across) < 1e-12) return 0;
        const double d = glm::dot(normal, q.corner - start) / across;
        const glm::dvec3 hit = start + d * perDepth - q.corner;
        const double a = glm::dot(hit, q.alongA) / glm::dot(q.alongA, q.alongA);
        const double b = glm::dot(hit, q.alongB) / glm::dot(q.alongB, q.alongB);
        return a >= 0 && a <= 1 && b >= 0 && b <= 1 ? d : 0;  // the edges are at right angles
    }
};

}  // namespace lodestar::shading

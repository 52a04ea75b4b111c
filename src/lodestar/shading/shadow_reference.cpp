// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/shadow_reference.hpp>

#include <algorithm>
#include <cmath>

namespace lodestar::shading {

using glm::dvec2, glm::dvec3, glm::dvec4;

double sunVisibilityReference(const shared::LightParams& light, const ShadowTexels& map,
                              dvec3 position, dvec3 faceNormal) {
    if (light.shadowTaps == 0) return 1;
    const dvec3 at(glm::dmat4(light.shadowFromWorld) * dvec4(position, 1));

    // Depth of the receiver's plane, per texel right and down. Its slope is limited where the face
    // is within 3° of edge-on to the sun.
    const double facing = glm::dot(faceNormal, dvec3(light.toSun));
    const double towards = facing < 0 ? std::min(facing, -0.05) : std::max(facing, 0.05);
    const double unit = double(light.shadowTexel) * light.shadowDepthScale;
    const dvec2 slope = dvec2(glm::dot(faceNormal, dvec3(light.shadowRight)),
                              glm::dot(faceNormal, dvec3(light.shadowUp))) *
                        (-unit / towards);
    const double bias = unit;

    const double n = light.shadowTaps;
    const dvec2 lower = dvec2(at) - n / 2, upper = lower + n;
    const int x0 = int(std::floor(lower.x)), y0 = int(std::floor(lower.y));
    if (x0 < 0 || y0 < 0 || x0 + int(n) >= map.width || y0 + int(n) >= map.height) return 1;

    double lit = 0;
    for (int y = y0; y <= y0 + int(n); ++y)
        for (int x = x0; x <= x0 + int(n); ++x) {
            const double width = std::min(x + 1.0, upper.x) - std::max(double(x), lower.x);
            const double height = std::min(y + 1.0, upper.y) - std::max(double(y), lower.y);
            const double plane = at.z + glm::dot(slope, dvec2(x, y) + 0.5 - dvec2(at)) + bias;
            const double occluder =
                map.depth[std::size_t(y) * std::size_t(map.width) + std::size_t(x)];
            if (occluder == 0 || plane >= occluder)
                lit += std::max(width, 0.0) * std::max(height, 0.0);
        }
    return lit / (n * n);
}

}  // namespace lodestar::shading

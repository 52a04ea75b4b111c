// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/light_visibility_reference.hpp>

#include <algorithm>
#include <cmath>

namespace lodestar::shading {

using glm::dvec2, glm::dvec3, glm::dvec4;

double lightVisibilityReference(const shared::GpuLightView& view, const DepthTexels& map, int taps,
                                dvec3 position, dvec3 faceNormal) {
    const dvec4 point(position, 1);
    const dvec2 at(glm::dot(dvec4(view.u), point), glm::dot(dvec4(view.v), point));

    // Depth of the receiver's plane, per texel right and down. Its slope is limited where the face
    // is within 3° of edge-on to the light.
    const double facing = glm::dot(faceNormal, dvec3(view.toLight));
    const double towards = facing < 0 ? std::min(facing, -0.05) : std::max(facing, 0.05);
    const dvec2 slope =
        dvec2(glm::dot(faceNormal, dvec3(view.u)), glm::dot(faceNormal, dvec3(view.v))) *
        (-double(view.planeScale) / towards);
    const double depth = glm::dot(dvec4(view.depth), point) + double(view.bias);

    const double n = taps;
    const dvec2 lower = at - n / 2, upper = lower + n;
    const int x0 = int(std::floor(lower.x)), y0 = int(std::floor(lower.y));
    if (x0 < 0 || y0 < 0 || x0 + taps >= map.width || y0 + taps >= map.height) return 1;

    double lit = 0;
    for (int y = y0; y <= y0 + taps; ++y)
        for (int x = x0; x <= x0 + taps; ++x) {
            const double width = std::min(x + 1.0, upper.x) - std::max(double(x), lower.x);
            const double height = std::min(y + 1.0, upper.y) - std::max(double(y), lower.y);
            const double plane = depth + glm::dot(slope, dvec2(x, y) + 0.5 - at);
            const double occluder =
                map.depth[std::size_t(y) * std::size_t(map.width) + std::size_t(x)];
            if (occluder == 0 || plane >= occluder)
                lit += std::max(width, 0.0) * std::max(height, 0.0);
        }
    return lit / (n * n);
}

double skyVisibilityReference(const shared::LightParams& light, std::span<const DepthTexels> maps,
                              dvec3 position, dvec3 faceNormal, dvec3 normal) {
    if (light.skyViewCount == 0) return 1;
    double seen = 0, all = 0;
    for (std::size_t i = 0; i < light.skyViewCount; ++i) {
        const shared::GpuLightView& view = light.views[i + 1];
        const double weight =
            double(view.weight) * (std::max(glm::dot(normal, dvec3(view.toLight)), 0.0) + 0.05);
        all += weight;
        seen += weight *
                lightVisibilityReference(view, maps[i], int(light.skyTaps), position, faceNormal);
    }
    return seen / all;
}

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/post_reference.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lodestar::post::reference {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::ivec2;

double occlusionAt(const Grid& grid, const std::vector<double>& depth, ivec2 texel, dvec3 n,
                   const SsaoOptions& o) {
    const dvec3 c = grid.viewPoint(texel, depth[grid.index(texel)]);
    const double side = n.z >= 0 ? 1 : -1;
    const double a = -1 / (side + n.z), b = n.x * n.y * a;
    const dvec3 t(1 + side * n.x * n.x * a, side * b, -side * n.x);
    const dvec3 u(b, side + n.y * n.y * a, -n.y);
    const int which = (texel.x % 3 + texel.y % 3 * 3) * 4 % 9;
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    double sum = 0;
    int inside = 0;
    for (std::uint32_t i = 0; i < o.samples; ++i) {
        const double height = 1 - (i + 0.5) / o.samples, wide = std::sqrt(1 - height * height);
        const double angle = which * 2 * std::numbers::pi / 9 + golden * i;
        double whole;
        const double far =
            o.radius * std::modf((i + 0.5) / std::numbers::phi + which / 9.0, &whole);
        const dvec3 s = c + far * (wide * (std::cos(angle) * t + std::sin(angle) * u) + height * n);
        const dvec2 ndc = dvec2(s) * grid.clipScale / std::max(-s.z, 1e-6) + grid.jitter;
        if (s.z >= 0 || std::abs(ndc.x) >= 1 || std::abs(ndc.y) >= 1) continue;
        const ivec2 at = grid.clamped(ivec2((ndc * 0.5 + 0.5) * dvec2(grid.fullSize) / grid.rate));
        const double z = depth[grid.index(at)];
        ++inside;
        if (z <= 0) continue;
        const dvec3 v = grid.viewPoint(at, z) - c;
        const double d = glm::length(v);
        if (d == 0) continue;
        sum += std::clamp(glm::dot(n, v) / d - o.bias, 0.0, 1.0) *
               std::clamp(1 - d * d / (double(o.radius) * o.radius), 0.0, 1.0);
    }
    return sum / std::max(inside, 1);
}

}  // namespace

dvec2 Grid::centreOnO(ivec2 texel) const {
    return glm::min((dvec2(texel) + 0.5) * rate, dvec2(fullSize) - 0.5);
}

dvec3 Grid::viewPoint(ivec2 texel, double z) const {
    const dvec2 ndc = centreOnO(texel) / dvec2(fullSize) * 2.0 - 1.0;
    return dvec3((ndc - jitter) / clipScale, -1) * z;
}

std::vector<double> ssao(const Grid& grid, const std::vector<double>& depth,
                         const std::vector<dvec3>& normal, const SsaoOptions& o) {
    std::vector<double> turned(depth.size()), result(depth.size());
    for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
            const std::size_t i = grid.index({x, y});
            if (depth[i] > 0) turned[i] = occlusionAt(grid, depth, {x, y}, normal[i], o);
        }
    for (int y = 0; y < grid.size.y; ++y)
        for (int x = 0; x < grid.size.x; ++x) {
            const std::size_t i = grid.index({x, y});
            if (depth[i] <= 0) continue;
            const dvec3 c = grid.viewPoint({x, y}, depth[i]);
            double sum = 0, weights = 0;
            for (int j = 0; j < 9; ++j) {
                const ivec2 at = grid.clamped({x + j % 3 - 1, y + j / 3 - 1});
                const double z = depth[grid.index(at)];
                if (z <= 0) continue;
                const double apart = std::abs(glm::dot(normal[i], grid.viewPoint(at, z) - c));
                const double w = std::max(1 - 2 * apart / o.radius, 0.0);
                sum += w * turned[grid.index(at)];
                weights += w;
            }
            result[i] = std::clamp(o.strength * sum / weights, 0.0, 1.0);
        }
    return result;
}

}  // namespace lodestar::post::reference

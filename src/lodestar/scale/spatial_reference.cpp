// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scale/spatial_reference.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace lodestar::scale::reference {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::ivec2;

/// All coordinates are in texels, texel i from i to i + 1.
dvec3 linearAt(const Picture& picture, dvec2 at) {
    const dvec2 base = floor(at - 0.5), f = at - 0.5 - base;
    const ivec2 first(base);
    return mix(mix(picture.at(first), picture.at(first + ivec2(1, 0)), f.x),
               mix(picture.at(first + ivec2(0, 1)), picture.at(first + ivec2(1, 1)), f.x), f.y);
}

/// Cubic B-spline of the distance to a tap, as a sum over all sixteen.
double spline(double x) {
    x = std::abs(x);
    if (x < 1) return 2.0 / 3 - x * x + x * x * x / 2;
    return x < 2 ? (2 - x) * (2 - x) * (2 - x) / 6 : 0;
}

/// An axis that is `same` is of the output's size, and stays as it is.
dvec3 bicubicAt(const Picture& picture, dvec2 at, glm::bvec2 same) {
    const ivec2 first(floor(at - 0.5));
    const auto weight = [](double x, bool exact) {
        return exact ? double(std::abs(x) < 0.5) : spline(x);
    };
    dvec3 sum(0);
    for (int y = -1; y <= 2; ++y)
        for (int x = -1; x <= 2; ++x) {
            const ivec2 texel = first + ivec2(x, y);
            const dvec2 to = at - (dvec2(texel) + 0.5);
            sum += weight(to.x, same.x) * weight(to.y, same.y) * picture.at(texel);
        }
    return sum;
}

dvec3 edgeAdaptiveAt(const Picture& picture, dvec2 at) {
    const dvec2 place = clamp(at, dvec2(0.5), dvec2(picture.size) - 0.5);
    const ivec2 first(floor(place - 0.5));
    const dvec2 f = place - 0.5 - floor(place - 0.5);
    const auto green = [&](int x, int y) { return picture.at(first + ivec2(x, y)).y; };
    const std::array quad{green(0, 0), green(1, 0), green(0, 1), green(1, 1)};
    const dvec2 slope(glm::mix(quad[1] - quad[0], quad[3] - quad[2], f.y),
                      glm::mix(quad[2] - quad[0], quad[3] - quad[1], f.x));
    const auto [low, high] = std::minmax_element(quad.begin(), quad.end());
    const double range = *high - *low, steep = dot(slope, slope) + 1e-4;
    const double value = linearAt(picture, place).y;
    const double chequered = std::abs(quad[0] + quad[3] - quad[1] - quad[2]) / (range + 1e-4);
    const double oriented = std::clamp(2 - chequered, 0.0, 1.0);
    const double ramp = (value - *low) / (range + 1e-4);
    const double steeper = ramp * ramp * (3 - 2 * ramp);
    const dvec2 across =
        clamp(slope * ((steeper - ramp) * range * 0.7 * oriented / steep), -0.5, 0.5);
    const dvec2 along =
        dvec2(-slope.y, slope.x) * (0.5 / std::sqrt(steep) * oriented * std::min(range / 0.1, 1.0));
    return 0.5 *
           (linearAt(picture, place + across + along) + linearAt(picture, place + across - along));
}

}  // namespace

dvec3 Picture::at(ivec2 texel) const {
    const ivec2 inside = glm::clamp(texel, ivec2(0), size - 1);
    return texels[static_cast<std::size_t>(inside.y) * static_cast<std::size_t>(size.x) +
                  static_cast<std::size_t>(inside.x)];
}

Picture scale(const Picture& source, ivec2 size, Filter filter) {
    assert(filter != Filter::noise && filter != Filter::noiseOffset);
    Picture out{size, {}};
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const dvec2 at = (dvec2(x, y) + 0.5) * dvec2(source.size) / dvec2(size);
            out.texels.push_back(filter == Filter::point ? source.at(ivec2(at))
                                 : filter == Filter::bicubic
                                     ? bicubicAt(source, at, glm::equal(source.size, size))
                                 : filter == Filter::edgeAdaptive ? edgeAdaptiveAt(source, at)
                                                                  : linearAt(source, at));
        }
    return out;
}

}  // namespace lodestar::scale::reference

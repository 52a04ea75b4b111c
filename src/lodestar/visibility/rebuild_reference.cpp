// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/rebuild_reference.hpp>

namespace lodestar::visibility::reference {
namespace {

double sum(glm::dvec3 v) {
    return v.x + v.y + v.z;
}

template <typename T>
T interpolated(const std::array<T, 3>& values, glm::dvec3 weights) {
    return values[0] * weights.x + values[1] * weights.y + values[2] * weights.z;
}

}  // namespace

Weights weightsAt(const std::array<glm::dvec4, 3>& clip, glm::dvec2 ndc) {
    const auto xyw = [](glm::dvec4 v) { return glm::dvec3(v.x, v.y, v.w); };
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(xyw(clip[0]), xyw(clip[1]), xyw(clip[2])));
    const glm::dvec3 overW = inverse * glm::dvec3(ndc, 1);  // b / w
    const double perW = sum(overW);                         // 1 / w

    Weights weights;
    weights.at = overW / perW;
    weights.dx = (inverse[0] - weights.at * sum(inverse[0])) / perW;
    weights.dy = (inverse[1] - weights.at * sum(inverse[1])) / perW;
    weights.depth = 1 / perW;
    return weights;
}

Surface rebuild(const Triangle& t, const glm::dmat4& clipFromWorld, glm::dvec2 point,
                glm::dvec2 size) {
    std::array<glm::dvec4, 3> clip;
    for (int i = 0; i < 3; ++i) clip[i] = clipFromWorld * glm::dvec4(t.world[i], 1);
    Surface surface;
    surface.weights = weightsAt(clip, point / size * 2.0 - 1.0);
    surface.position = interpolated(t.world, surface.weights.at);
    surface.normal = glm::normalize(interpolated(t.normal, surface.weights.at));
    surface.uv = interpolated(t.uv, surface.weights.at);
    surface.uvDx = interpolated(t.uv, surface.weights.dx) * (2 / size.x);
    surface.uvDy = interpolated(t.uv, surface.weights.dy) * (2 / size.y);
    return surface;
}

}  // namespace lodestar::visibility::reference

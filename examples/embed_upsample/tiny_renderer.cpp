// SPDX-License-Identifier: Apache-2.0
#include "tiny_renderer.hpp"

#include <cmath>

namespace tiny {
namespace {

struct Ball {
    glm::vec3 centre;
    float radius;
    glm::vec3 albedo;
};
// View space: the eye at the origin looks along −z.
constexpr Ball kBalls[] = {{{-1.1f, -0.2f, -5.0f}, 0.8f, {0.8f, 0.25f, 0.2f}},
                           {{0.5f, -0.45f, -4.2f}, 0.55f, {0.25f, 0.6f, 0.3f}},
                           {{1.5f, 0.0f, -6.5f}, 1.0f, {0.25f, 0.35f, 0.8f}}};
constexpr float kGround = -1.0f, kFar = 14.0f;

struct Hit {
    float t = 0;  ///< 0 = nothing
    glm::vec3 normal{0, 0, 1}, albedo{0};
};

Hit cast(glm::vec3 from, glm::vec3 along) {
    Hit hit;
    if (along.y < 0) {
        const float t = (kGround - from.y) / along.y;
        const glm::vec3 p = from + t * along;
        if (t > 1e-3f && -p.z < kFar) {
            const bool dark = (int(std::floor(p.x)) + int(std::floor(p.z))) % 2 != 0;
            hit = {t, {0, 1, 0}, glm::vec3(dark ? 0.35f : 0.7f)};
        }
    }
    for (const Ball& ball : kBalls) {
        const glm::vec3 to = ball.centre - from;
        const float middle = glm::dot(to, along);
        const float inside = ball.radius * ball.radius - glm::dot(to, to) + middle * middle;
        const float t = inside < 0 ? 0 : middle - std::sqrt(inside);
        if (t > 1e-3f && (hit.t == 0 || t < hit.t))
            hit = {t, glm::normalize(from + t * along - ball.centre), ball.albedo};
    }
    return hit;
}

/// Through a point of the picture, in pixels.
glm::vec3 ray(float x, float y, int width, int height) {
    return glm::normalize(glm::vec3((2 * x - float(width)) / float(height),
                                    (float(height) - 2 * y) / float(height), -2.0f));
}

glm::vec3 lightAt(glm::vec3 p, glm::vec3 normal) {
    constexpr int kSide = 12;  // samples of the square lamp
    glm::vec3 sum(0.12f, 0.14f, 0.18f);
    for (int i = 0; i < kSide * kSide; ++i) {
        const glm::vec2 on = (glm::vec2(i % kSide, i / kSide) + 0.5f) / float(kSide) - 0.5f;
        const glm::vec3 to = glm::vec3(-3 + 1.5f * on.x, 5, -2 + 1.5f * on.y) - p;
        const float cosine = glm::dot(glm::normalize(to), normal);
        if (cosine <= 0 || cast(p + 2e-3f * normal, glm::normalize(to)).t != 0) continue;
        sum += cosine / float(kSide * kSide);
    }
    return sum;
}

}  // namespace

GBuffer drawGBuffer(int width, int height) {
    GBuffer g{.width = width, .height = height};
    for (int i = 0; i < width * height; ++i) {
        const glm::vec3 along =
            ray(float(i % width) + 0.5f, float(i / width) + 0.5f, width, height);
        const Hit hit = cast(glm::vec3(0), along);
        g.depth.push_back(-hit.t * along.z);
        g.normal.push_back(hit.normal);
        g.albedo.push_back(hit.albedo);
    }
    return g;
}

Lighting shade(int width, int height, float rate) {
    Lighting s{.width = int(std::ceil(float(width) / rate)),
               .height = int(std::ceil(float(height) / rate))};
    for (int i = 0; i < s.width * s.height; ++i) {
        const glm::vec3 along = ray((float(i % s.width) + 0.5f) * rate,
                                    (float(i / s.width) + 0.5f) * rate, width, height);
        const Hit hit = cast(glm::vec3(0), along);
        s.light.push_back(hit.t == 0 ? glm::vec3(0) : lightAt(hit.t * along, hit.normal));
        s.depth.push_back(-hit.t * along.z);
        s.normal.push_back(hit.normal);
    }
    return s;
}

}  // namespace tiny

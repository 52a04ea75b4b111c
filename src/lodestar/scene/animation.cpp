// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

namespace {

/// The parts of a node's transform that animation moves.
struct Parts {
    glm::vec3 translation;
    glm::quat rotation;
    glm::vec3 scale;
};

glm::quat asRotation(glm::vec4 xyzw) {
    const float length = glm::length(xyzw);
    if (!(length > 0)) return {1, 0, 0, 0};
    return glm::quat(xyzw.w, xyzw.x, xyzw.y, xyzw.z) / length;
}

/// The cubic Hermite spline of glTF 2.0, appendix C: `gap` is the time between the two keys.
template <typename T>
T spline(T from, T leaving, T to, T arriving, float gap, float t) {
    const float t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * from + gap * (t3 - 2 * t2 + t) * leaving +
           (3 * t2 - 2 * t3) * to + gap * (t3 - t2) * arriving;
}

/// Between which keys a moment lies.
struct Between {
    std::size_t first;
    float gap = 0, t = 0;  ///< 0: at the first
};

/// Held before the first and after the last key.
Between keysAt(const AnimationChannel& channel, float seconds) {
    const auto after = std::upper_bound(channel.times.begin(), channel.times.end(), seconds);
    if (after == channel.times.begin()) return {0};
    const std::size_t i = static_cast<std::size_t>(after - channel.times.begin()) - 1;
    if (after == channel.times.end() || channel.interpolation == Interpolation::step) return {i};
    const float gap = channel.times[i + 1] - channel.times[i];
    return {i, gap, (seconds - channel.times[i]) / gap};
}

/// The channel's value at `seconds`.
glm::vec4 sample(const AnimationChannel& channel, float seconds) {
    const bool cubic = channel.interpolation == Interpolation::cubicSpline;
    const auto key = [&](std::size_t i) { return channel.values[cubic ? 3 * i + 1 : i]; };
    const auto [i, gap, t] = keysAt(channel, seconds);
    if (gap == 0) return key(i);
    if (cubic)
        return spline(key(i), channel.values[3 * i + 2], key(i + 1), channel.values[3 * i + 3], gap,
                      t);
    if (channel.path != AnimationPath::rotation) return glm::mix(key(i), key(i + 1), t);
    const glm::quat rotation = glm::slerp(asRotation(key(i)), asRotation(key(i + 1)), t);
    return {rotation.x, rotation.y, rotation.z, rotation.w};
}

void sampleWeights(const AnimationChannel& channel, float seconds, std::vector<float>& weights) {
    const bool cubic = channel.interpolation == Interpolation::cubicSpline;
    const auto [i, gap, t] = keysAt(channel, seconds);
    const std::size_t count = weights.size();
    for (std::size_t w = 0; w < count; ++w) {
        const auto at = [&](std::size_t k) { return channel.weights[k * count + w]; };
        const auto key = [&](std::size_t k) { return at(cubic ? 3 * k + 1 : k); };
        weights[w] = gap == 0 ? key(i)
                     : cubic  ? spline(key(i), at(3 * i + 2), key(i + 1), at(3 * i + 3), gap, t)
                              : glm::mix(key(i), key(i + 1), t);
    }
}

void apply(const Animation& animation, float seconds, std::vector<Parts>& parts, Pose& moved) {
    float looped = seconds;
    if (animation.duration > 0) {
        looped = std::fmod(seconds, animation.duration);
        if (looped < 0) looped += animation.duration;
    }
    for (const AnimationChannel& channel : animation.channels) {
        if (channel.times.empty()) continue;
        if (channel.path == AnimationPath::weights) {
            const auto weights = moved.weights.find(channel.node);
            if (weights != moved.weights.end()) sampleWeights(channel, looped, weights->second);
            continue;
        }
        const glm::vec4 value = sample(channel, looped);
        Parts& pose = parts[channel.node];
        switch (channel.path) {
            case AnimationPath::translation:
                pose.translation = value;
                break;
            case AnimationPath::rotation:
                pose.rotation = asRotation(value);
                break;
            case AnimationPath::scale:
                pose.scale = value;
                break;
            case AnimationPath::weights:
                break;
        }
    }
}

}  // namespace

Pose poseAt(const Scene& scene, float seconds) {
    std::vector<Parts> parts;
    parts.reserve(scene.nodes.size());
    Pose pose;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        parts.push_back({node.translation, node.rotation, node.scale});
        if (!node.weights.empty())
            pose.weights.emplace(static_cast<std::uint32_t>(i), node.weights);
    }
    if (!scene.animations.empty()) apply(scene.animations.front(), seconds, parts, pose);

    std::vector<glm::mat4>& world = pose.worldFromNode;
    world.reserve(scene.nodes.size());
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        const Parts& own = parts[i];
        const glm::mat4 local = node.hasMatrix
                                    ? node.matrix
                                    : glm::scale(glm::translate(glm::mat4(1), own.translation) *
                                                     glm::mat4_cast(own.rotation),
                                                 own.scale);
        world.push_back(node.parent == kNone ? local : world[node.parent] * local);
    }
    return pose;
}

std::vector<glm::mat4> worldFromNode(const Scene& scene, float seconds) {
    return poseAt(scene, seconds).worldFromNode;
}

}  // namespace lodestar::scene

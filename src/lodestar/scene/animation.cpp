// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

namespace {

/// The parts of a node's transform that animation moves.
struct Pose {
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
glm::vec4 spline(glm::vec4 from, glm::vec4 leaving, glm::vec4 to, glm::vec4 arriving, float gap,
                 float t) {
    const float t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * from + gap * (t3 - 2 * t2 + t) * leaving +
           (3 * t2 - 2 * t3) * to + gap * (t3 - t2) * arriving;
}

/// The channel's value at `seconds`; held before the first and after the last key.
glm::vec4 sample(const AnimationChannel& channel, float seconds) {
    const bool cubic = channel.interpolation == Interpolation::cubicSpline;
    const auto key = [&](std::size_t i) { return channel.values[cubic ? 3 * i + 1 : i]; };
    const auto after = std::upper_bound(channel.times.begin(), channel.times.end(), seconds);
    if (after == channel.times.begin()) return key(0);
    const std::size_t i = static_cast<std::size_t>(after - channel.times.begin()) - 1;
    if (after == channel.times.end() || channel.interpolation == Interpolation::step) return key(i);
    const float gap = channel.times[i + 1] - channel.times[i];
    const float t = (seconds - channel.times[i]) / gap;
    if (cubic)
        return spline(key(i), channel.values[3 * i + 2], key(i + 1), channel.values[3 * i + 3], gap,
                      t);
    if (channel.path != AnimationPath::rotation) return glm::mix(key(i), key(i + 1), t);
    const glm::quat rotation = glm::slerp(asRotation(key(i)), asRotation(key(i + 1)), t);
    return {rotation.x, rotation.y, rotation.z, rotation.w};
}

void apply(const Animation& animation, float seconds, std::vector<Pose>& poses) {
    float looped = seconds;
    if (animation.duration > 0) {
        looped = std::fmod(seconds, animation.duration);
        if (looped < 0) looped += animation.duration;
    }
    for (const AnimationChannel& channel : animation.channels) {
        if (channel.times.empty()) continue;
        const glm::vec4 value = sample(channel, looped);
        Pose& pose = poses[channel.node];
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
        }
    }
}

}  // namespace

std::vector<glm::mat4> worldFromNode(const Scene& scene, float seconds) {
    std::vector<Pose> poses;
    poses.reserve(scene.nodes.size());
    for (const Node& node : scene.nodes)
        poses.push_back({node.translation, node.rotation, node.scale});
    if (!scene.animations.empty()) apply(scene.animations.front(), seconds, poses);

    std::vector<glm::mat4> world;
    world.reserve(scene.nodes.size());
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const Node& node = scene.nodes[i];
        const Pose& pose = poses[i];
        const glm::mat4 local = node.hasMatrix
                                    ? node.matrix
                                    : glm::scale(glm::translate(glm::mat4(1), pose.translation) *
                                                     glm::mat4_cast(pose.rotation),
                                                 pose.scale);
        world.push_back(node.parent == kNone ? local : world[node.parent] * local);
    }
    return world;
}

}  // namespace lodestar::scene

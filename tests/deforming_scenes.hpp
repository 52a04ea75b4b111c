// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "small_scenes.hpp"

/// Scenes whose meshes joints and morph weights deform.
namespace small_scenes {

/// A tube along y from 0 to 2, held by three joints in a row and with two morph targets: one that
/// makes it fat, one that leans it.
inline Mesh tube(std::uint32_t material) {
    Mesh mesh = parts::patch(parts::rod({0, 2, 0}, {0, 0, 0}, 0.3), 24, 32, {1, 1});
    mesh.material = material;
    mesh.jointsPerVertex = 2;
    lodestar::scene::MorphTarget fat, lean;
    for (const auto& v : mesh.vertices) {
        const float along = std::min(v.position.y, 1.9999f);  // a joint at 0, 1 and 2
        const auto joint = static_cast<std::uint32_t>(along);
        const float t = along - float(joint);
        mesh.influences.push_back({joint, 1 - t});
        mesh.influences.push_back({joint + 1, t});
        fat.position.push_back(0.2f * v.normal);
        lean.position.push_back({0.3f * along * along, 0, 0});
        lean.normal.push_back({0, -0.4f * along * v.normal.x, 0});
        lean.tangent.push_back({0, 0.1f * along, 0});
    }
    mesh.targets = {fat, lean};
    mesh.boundDeformation();
    return mesh;
}

/// Two tubes of one mesh, each with joints and weights of its own, and one that only morphs, on a
/// node that moves too; before a wall and a box, which stay. The animation takes two seconds.
inline Scene wavingTubes() {
    using lodestar::scene::AnimationPath;
    using lodestar::scene::Interpolation;
    SceneBuilder builder("waving tubes");
    const auto plain = builder.add(parts::plain("plain", {0.7f, 0.4f, 0.2f}, 0, 0.6f));
    const auto wall = builder.add("wall", parts::box({-4, -0.5, -2.2}, {4, 3.5, -2}, 1), plain);
    const auto box = builder.add("box", parts::box({-0.4, -0.4, 0.8}, {0.5, 1.2, 1.4}, 1), plain);
    const auto mesh = builder.add("tube", tube(plain), plain);
    builder.place(wall, {0, 0, 0});
    builder.place(box, {0, 0, 0});
    Scene scene = std::move(builder).finish();
    lodestar::scene::Animation waving{.name = "waving", .duration = 2, .channels = {}};
    const auto node = [&](lodestar::scene::Node n) {
        scene.nodes.push_back(std::move(n));
        return static_cast<std::uint32_t>(scene.nodes.size() - 1);
    };
    const std::uint32_t origin = node({});
    for (int i = 0; i < 2; ++i) {
        lodestar::scene::Skin skin;
        std::uint32_t parent = lodestar::scene::kNone;
        for (int j = 0; j < 3; ++j) {
            lodestar::scene::Node joint;
            joint.parent = parent;
            joint.translation =
                j == 0 ? glm::vec3(-1.6f + 3.2f * float(i), 0, 0) : glm::vec3(0, 1, 0);
            if (j == 0 && i == 1) joint.scale = {1.2f, 0.8f, 1.1f};
            parent = node(joint);
            skin.joints.push_back(parent);
            skin.jointFromBind.push_back(glm::translate(glm::mat4(1), glm::vec3(0, -float(j), 0)));
            const float angle = (0.5f + 0.3f * float(j)) * (i == 0 ? 1 : -1);
            const glm::vec3 axis = i == 0 ? glm::vec3(0, 0, 1) : glm::normalize(glm::vec3(1, 0, 1));
            const glm::vec4 to(axis * std::sin(angle / 2), std::cos(angle / 2));
            waving.channels.push_back({.node = parent,
                                       .path = AnimationPath::rotation,
                                       .interpolation = Interpolation::linear,
                                       .times = {0, 1, 2},
                                       .values = {{0, 0, 0, 1}, to, {0, 0, 0, 1}},
                                       .weights = {}});
        }
        scene.skins.push_back(skin);
        lodestar::scene::Node weights;
        weights.weights = {0, 0.5f};
        const std::uint32_t own = node(weights);
        if (i == 1)
            waving.channels.push_back({.node = own,
                                       .path = AnimationPath::weights,
                                       .interpolation = Interpolation::linear,
                                       .times = {0, 1, 2},
                                       .values = {},
                                       .weights = {0, 0.5f, 1, -0.5f, 0, 0.5f}});
        scene.instances.push_back({.mesh = mesh,
                                   .node = origin,
                                   .skin = static_cast<std::uint32_t>(i),
                                   .weightsNode = own});
    }
    lodestar::scene::Node morphing;
    morphing.weights = {0.2f, 0};
    morphing.translation = {0, 0.4f, -1};
    const std::uint32_t own = node(morphing);
    waving.channels.push_back({.node = own,
                               .path = AnimationPath::translation,
                               .interpolation = Interpolation::linear,
                               .times = {0, 1, 2},
                               .values = {{0, 0.4f, -1, 0}, {0.5f, 0.6f, -1, 0}, {0, 0.4f, -1, 0}},
                               .weights = {}});
    waving.channels.push_back({.node = own,
                               .path = AnimationPath::weights,
                               .interpolation = Interpolation::cubicSpline,
                               .times = {0, 2},
                               .values = {},
                               .weights = {0, 0, 0.2f, 0, 2, 1, -2, -1, 0.2f, 0, 0, 0}});
    scene.instances.push_back({.mesh = mesh, .node = own, .weightsNode = own});
    scene.animations.push_back(waving);
    return scene;
}

}  // namespace small_scenes

// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <lodestar/scene/procedural_parts.hpp>
#include <lodestar/scene/procedural_scenes.hpp>
#include <lodestar/scene/procedural_textures.hpp>

namespace lodestar::scene::procedural {
namespace {

constexpr int kRoughnesses = 9, kMetallics = 5;
constexpr float kRadius = 0.45f, kSpacing = 1.1f;

/// A saturated colour of the colour wheel, linear.
glm::vec3 hue(float turn) {
    const auto channel = [&](float shift) {
        const float c = 0.5f + 0.5f * std::cos(2 * std::numbers::pi_v<float> * (turn - shift));
        return 0.05f + 0.75f * c * c;
    };
    return {channel(0), channel(1 / 3.0f), channel(2 / 3.0f)};
}

}  // namespace

Scene buildSpheres() {
    SceneBuilder builder("builtin:spheres");
    Surfacing tiles = checkerFloor();
    Material ground = plain("floor", glm::vec3(0.8f), 0, 1);
    ground.baseColorTexture = builder.add(std::move(tiles.baseColor), ColorSpace::srgb);
    ground.normalTexture = builder.add(std::move(tiles.normal), ColorSpace::linear);
    ground.metallicRoughnessTexture =
        builder.add(std::move(tiles.metallicRoughness), ColorSpace::linear);
    const std::uint32_t floor =
        builder.add("floor", patch(rectangle({-8, 0, -6}, {16, 0, 0}, {0, 0, 12}), 16, 12, {4, 3}),
                    builder.add(ground));
    builder.place(floor);

    const Mesh ball = patch(sphere(kRadius), 48, 24, {4, 2});
    for (int row = 0; row < kMetallics; ++row)
        for (int column = 0; column < kRoughnesses; ++column) {
            const float metallic = static_cast<float>(row) / (kMetallics - 1);
            const float roughness = static_cast<float>(column) / (kRoughnesses - 1);
            const std::string name =
                fmt::format("metallic {:.2f} roughness {:.3f}", metallic, roughness);
            const glm::vec3 color = hue(static_cast<float>(row) / kMetallics);
            const std::uint32_t material = builder.add(plain(name, color, metallic, roughness));
            const float x = kSpacing * (static_cast<float>(column) - 0.5f * (kRoughnesses - 1));
            const float z = kSpacing * (0.5f * (kMetallics - 1) - static_cast<float>(row));
            builder.place(builder.add(name, ball, material), {x, kRadius, z});
        }
    builder.addCamera("front", {0, 4.6f, 9.2f}, {0, 0.2f, 0.2f}, 0.75f);
    builder.addCamera("low", {-5.4f, 0.9f, 4.2f}, {0, 0.4f, -0.4f}, 0.8f);
    return std::move(builder).finish();
}

}  // namespace lodestar::scene::procedural

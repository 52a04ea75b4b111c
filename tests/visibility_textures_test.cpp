// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <lodestar/scene/mipmaps.hpp>

#include "gpu_device.hpp"
#include "small_scenes.hpp"
#include "visibility_view.hpp"

namespace lodestar::visibility {
namespace {

using small_scenes::facing;
using small_scenes::Image;
using small_scenes::quad;
using small_scenes::single;

class TextureTest : public GpuTest {};

/// `texel(x, y)` gives RGBA.
template <typename Texel>
Image image(int width, int height, Texel texel) {
    Image picture{.name = "image", .width = width, .height = height, .rgba = {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::array<int, 4> rgba = texel(x, y);
            for (const int c : rgba) picture.rgba.push_back(std::uint8_t(c));
        }
    return picture;
}

/// A texel's place in its colour: g = x, b = y, which becomes roughness and metallic.
Image ramp() {
    return image(256, 256, [](int x, int y) { return std::array{0, x, y, 255}; });
}

/// The value of the ramp at a coordinate, between its outermost texel centres.
double rampAt(double u) {
    return (u * 256 - 0.5) / 255;
}

/// quad() with the ramp as its metallic-roughness texture.
Scene rampScene(const scene::TextureUse& how = {}, scene::Wrap wrap = scene::Wrap::repeat,
                glm::vec2 repeats = {1, 1}) {
    small_scenes::SceneBuilder builder("ramp");
    scene::Material material;
    const std::uint32_t texture = builder.add(ramp(), small_scenes::ColorSpace::linear).texture;
    material.metallicRoughnessTexture = how;
    material.metallicRoughnessTexture.texture = texture;
    builder.place(builder.add("quad", quad(repeats), builder.add(material)));
    Scene scene = std::move(builder).finish();
    scene.textures[texture].wrapU = scene.textures[texture].wrapV = wrap;
    return scene;
}

constexpr double kCode = 1 / 255.0;

TEST_F(TextureTest, uvEqualsTheReferenceInPerspective) {
    View view(device(), rampScene());
    const Camera camera{.eye = {1.5f, -1.2f, 1.8f}, .at = {0, 0, 0}, .verticalFov = 0.9f};
    const Picture p = view.draw(camera, {64, 48});
    int compared = 0;
    for (std::size_t i = 0; i < p.ids.size(); ++i) {
        if (p.ids[i] == 0) continue;
        const auto s = view.expected(p, i, camera);
        const glm::dvec2 margin = 4.0 / 256 + 2.0 * (glm::abs(s.uvDx) + glm::abs(s.uvDy));
        if (glm::any(glm::lessThan(s.uv, margin)) || glm::any(glm::greaterThan(s.uv, 1.0 - margin)))
            continue;  // filtering reaches over the edge
        ++compared;
        EXPECT_NEAR(p.roughMetal(i).x, rampAt(s.uv.x), 1.6 * kCode) << "pixel " << i;
        EXPECT_NEAR(p.roughMetal(i).y, rampAt(s.uv.y), 1.6 * kCode) << "pixel " << i;
    }
    EXPECT_GT(compared, 300);
}

TEST_F(TextureTest, firstRowOfAnImageIsAtTheTop) {
    small_scenes::SceneBuilder builder("colours");
    scene::Material material;
    material.baseColorTexture =
        builder.add(image(2, 2,
                          [](int x, int y) {
                              return std::array{x == 0 ? 255 : 0, y == 0 ? 255 : 0,
                                                x == 1 && y == 1 ? 255 : 0, 255};
                          }),
                    small_scenes::ColorSpace::srgb);
    builder.place(builder.add("quad", quad(), builder.add(material)));
    View view(device(), std::move(builder).finish());
    const Picture p = view.draw(facing(), {34, 34});  // pixel 8 has its centre at 1/4
    const auto expect = [&](std::uint32_t x, std::uint32_t y, glm::vec3 color) {
        EXPECT_LT(glm::length(glm::vec3(p.albedo(p.at(x, y))) - color), 0.02f) << x << ' ' << y;
    };
    expect(8, 8, {1, 1, 0});
    expect(25, 8, {0, 1, 0});
    expect(8, 25, {1, 0, 0});
    expect(25, 25, {0, 0, 1});
}

TEST_F(TextureTest, baseColorIsDecodedFromSrgbAndMultiplied) {
    small_scenes::SceneBuilder builder("grey");
    scene::Material material;
    material.baseColor = {1, 0.5f, 0.25f, 1};
    material.baseColorTexture = builder.add(image(4, 4,
                                                  [](int, int) {
                                                      return std::array{188, 188, 188, 255};
                                                  }),
                                            small_scenes::ColorSpace::srgb);
    builder.place(builder.add("quad", quad(), builder.add(material)));
    View view(device(), std::move(builder).finish());
    const Picture p = view.draw(facing(), {8, 8});
    const float linear = scene::linearFromCode(188, scene::ColorSpace::srgb);
    for (std::size_t i = 0; i < p.ids.size(); ++i)
        EXPECT_LT(glm::length(glm::vec3(p.albedo(i)) - linear * glm::vec3(1, 0.5f, 0.25f)), 0.01f);
}

TEST_F(TextureTest, transformsMoveTheCoordinates) {
    // u' = v/2 + 1/4, v' = u/2 + 1/8
    View view(device(), rampScene({.transform = glm::mat3x2(0, 0.5f, 0.5f, 0, 0.25f, 0.125f)}));
    const Picture p = view.draw(facing(), {32, 32});
    for (std::size_t i = 0; i < p.ids.size(); ++i) {
        const glm::vec2 uv = p.centre(i) / 32.0f;
        EXPECT_NEAR(p.roughMetal(i).x, rampAt(uv.y / 2 + 0.25), 2.1 * kCode);
        EXPECT_NEAR(p.roughMetal(i).y, rampAt(uv.x / 2 + 0.125), 2.1 * kCode);
    }
}

TEST_F(TextureTest, theSecondUvSetIsUsedWhereAskedFor) {
    Scene scene = rampScene({.uvSet = 1});
    for (scene::Vertex& v : scene.meshes[0].vertices) v.uv1 = 0.25f + 0.5f * (1.0f - v.uv0);
    View view(device(), std::move(scene));
    const Picture p = view.draw(facing(), {32, 32});
    for (std::size_t i = 0; i < p.ids.size(); ++i) {
        const glm::vec2 uv = 0.25f + 0.5f * (1.0f - p.centre(i) / 32.0f);
        EXPECT_NEAR(p.roughMetal(i).x, rampAt(uv.x), 2.1 * kCode);
        EXPECT_NEAR(p.roughMetal(i).y, rampAt(uv.y), 2.1 * kCode);
    }
}

TEST_F(TextureTest, wrapModesRepeatMirrorAndClamp) {
    // 8 texels a pixel: level 3, whose outermost texel centres are 4 texels inside.
    const auto wrapped = [](scene::Wrap wrap, double u) {
        if (wrap == scene::Wrap::repeat) return u - std::floor(u);
        if (wrap == scene::Wrap::mirroredRepeat) u = 1 - std::abs(u - 2 * std::floor(u / 2) - 1);
        return std::clamp(u, 4.0 / 256, 1 - 4.0 / 256);
    };
    for (const auto wrap :
         {scene::Wrap::repeat, scene::Wrap::mirroredRepeat, scene::Wrap::clampToEdge}) {
        View view(device(), rampScene({}, wrap, {3, 3}));
        const Picture p = view.draw(facing(), {96, 96});
        for (std::size_t i = 0; i < p.ids.size(); ++i) {
            const glm::vec2 uv = p.centre(i) / 32.0f;
            ASSERT_NEAR(p.roughMetal(i).x, rampAt(wrapped(wrap, uv.x)), 2.1 * kCode)
                << int(wrap) << " pixel " << i;
            ASSERT_NEAR(p.roughMetal(i).y, rampAt(wrapped(wrap, uv.y)), 2.1 * kCode)
                << int(wrap) << " pixel " << i;
        }
    }
}

TEST_F(TextureTest, gradientsPickTheMipLevelWhoseTexelsArePixels) {
    small_scenes::Random random(21);
    constexpr int kSize = 128;
    const Image noise = image(kSize, kSize, [&](int, int) {
        return std::array{0, int(random(0, 256)), int(random(0, 256)), 255};
    });
    std::vector<std::vector<std::uint8_t>> mips{noise.rgba};
    std::vector<std::uint8_t*> levels;
    for (int l = 1; l < 8; ++l) mips.emplace_back(std::size_t(4) * (kSize >> l) * (kSize >> l));
    for (int l = 1; l < 8; ++l) levels.push_back(mips[std::size_t(l)].data());
    scene::writeMips(noise.rgba.data(), kSize, kSize, scene::ColorSpace::linear, levels);

    small_scenes::SceneBuilder builder("noise");
    scene::Material material;
    material.metallicRoughnessTexture = builder.add(noise, small_scenes::ColorSpace::linear);
    builder.place(builder.add("quad", quad(), builder.add(material)));
    View view(device(), std::move(builder).finish());
    for (int level = 0; level < 5; ++level) {
        const auto side = std::uint32_t(kSize >> level);
        const Picture p = view.draw(facing(), {side, side});
        for (std::size_t i = 0; i < p.ids.size(); ++i) {
            const std::uint8_t* texel = &mips[std::size_t(level)][4 * i];
            ASSERT_NEAR(p.roughMetal(i).x, texel[1] * kCode, 4.1 * kCode) << level << ' ' << i;
            ASSERT_NEAR(p.roughMetal(i).y, texel[2] * kCode, 4.1 * kCode) << level << ' ' << i;
        }
    }
}

TEST_F(TextureTest, aRecedingFloorIsSharpNearAndEvenFar) {
    small_scenes::SceneBuilder builder("floor");
    scene::Material material;
    material.metallicRoughnessTexture = builder.add(image(64, 64,
                                                          [](int x, int y) {
                                                              const int c = (x ^ y) & 1 ? 255 : 0;
                                                              return std::array{0, c, c, 255};
                                                          }),
                                                    small_scenes::ColorSpace::linear);
    const auto floor = small_scenes::parts::rectangle({-20, 0, -80}, {40, 0, 0}, {0, 0, 80});
    builder.place(builder.add("floor", small_scenes::parts::patch(floor, 1, 1, {5, 10}),
                              builder.add(material)));
    View view(device(), std::move(builder).finish());
    const Camera camera{.eye = {0, 0.6f, 0}, .at = {0, 0.2f, -1}};
    const Picture p = view.draw(camera, {64, 64});
    float lowest = 1, highest = 0;
    int far = 0;
    for (std::size_t i = 0; i < p.ids.size(); ++i) {
        if (p.ids[i] == 0) continue;
        const float value = p.roughMetal(i).x;
        if (p.depths[i] < 1) {
            lowest = std::min(lowest, value);
            highest = std::max(highest, value);
        } else if (p.depths[i] > 25 && p.depths[i] < 60) {
            ++far;
            EXPECT_NEAR(value, 0.5f, 0.02f) << "pixel " << i;
        }
    }
    EXPECT_LT(lowest, 0.1f);
    EXPECT_GT(highest, 0.9f);
    EXPECT_GT(far, 30);
}

/// quad() whose left half has alpha 100/255, its right half 200/255.
Scene halves(const scene::Material& base) {
    small_scenes::SceneBuilder builder("halves");
    scene::Material material = base;
    material.baseColorTexture =
        builder.add(image(64, 4,
                          [](int x, int) {
                              return std::array{255, 255, 255, x < 32 ? 100 : 200};
                          }),
                    small_scenes::ColorSpace::srgb);
    builder.place(builder.add("quad", quad(), builder.add(material)));
    return std::move(builder).finish();
}

/// Whether a pixel in the left and in the right half shows the surface.
std::pair<bool, bool> shown(const gpu::Device& device, Scene scene) {
    View view(device, std::move(scene));
    const Picture p = view.draw(facing(), {32, 32});
    for (std::uint32_t y = 0; y < 32; ++y)
        for (const std::uint32_t x : {2u, 13u, 19u, 29u})
            EXPECT_EQ(p.ids[p.at(x, y)] != 0, p.ids[p.at(x < 16 ? 8 : 24, 16)] != 0);
    return {p.ids[p.at(8, 16)] != 0, p.ids[p.at(24, 16)] != 0};
}

TEST_F(TextureTest, alphaMasksHonourTheCutoff) {
    using Shown = std::pair<bool, bool>;
    scene::Material material{.alphaMode = scene::AlphaMode::mask};
    EXPECT_EQ(shown(device(), halves(material)), Shown(false, true));
    material.alphaCutoff = 0.3f;
    EXPECT_EQ(shown(device(), halves(material)), Shown(true, true));
    material.alphaCutoff = 0.9f;
    EXPECT_EQ(shown(device(), halves(material)), Shown(false, false));
    material.alphaCutoff = 0.5f;
    material.baseColor.a = 0.6f;  // 200/255 · 0.6 < 0.5
    EXPECT_EQ(shown(device(), halves(material)), Shown(false, false));

    EXPECT_EQ(shown(device(), halves({})), Shown(true, true));  // opaque
    // Blended surfaces only where they are opaque, whatever their cutoff.
    EXPECT_EQ(shown(device(), halves({.alphaMode = scene::AlphaMode::blend, .alphaCutoff = 0.1f})),
              Shown(false, false));
}

TEST_F(TextureTest, vertexAlphaCountsInMasks) {
    Scene scene = halves({.alphaMode = scene::AlphaMode::mask});
    for (scene::Vertex& v : scene.meshes[0].vertices) v.color.a = 0.5f;
    EXPECT_EQ(shown(device(), std::move(scene)), std::pair(false, false));
}

}  // namespace
}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/texture_arrays.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace lodestar::scene {
namespace {

using Rgba = std::array<std::uint8_t, 4>;

template <typename Color>
Image image(int width, int height, const Color& color) {
    Image made;
    made.width = width;
    made.height = height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (std::uint8_t c : Rgba(color(x, y))) made.rgba.push_back(c);
    return made;
}

Image plain(int width, int height, Rgba color) {
    return image(width, height, [&](int, int) { return color; });
}

Image noise(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    return image(width, height, [&](int, int) {
        const auto r = static_cast<std::uint32_t>(random());
        return Rgba{std::uint8_t(r), std::uint8_t(r >> 8), std::uint8_t(r >> 16),
                    std::uint8_t(r >> 24)};
    });
}

Scene sceneOf(std::vector<Image> images, ColorSpace space) {
    Scene scene;
    for (std::uint32_t i = 0; i < images.size(); ++i) scene.textures.push_back({i, space});
    scene.images = std::move(images);
    return scene;
}

struct Level {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;

    int at(int x, int y, int channel) const {
        return rgba[static_cast<std::size_t>((y * width + x) * 4 + channel)];
    }
};

Level level(const TextureArrays& arrays, std::size_t texture, std::uint32_t mip) {
    const TextureSlot slot = arrays.slotOf.at(texture);
    const TextureArray& array = arrays.arrays.at(slot.array);
    Level result{std::max(1, array.width >> mip), std::max(1, array.height >> mip), {}};
    const auto bytes = static_cast<std::size_t>(result.width * result.height * 4);
    const auto* from = array.texels.data() + array.levelOffset(mip) + slot.layer * bytes;
    EXPECT_LE(from + bytes, array.texels.data() + array.texels.size());
    result.rgba.assign(from, from + bytes);
    return result;
}

double linearOf(int code) {
    const double s = code / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

TEST(TextureArrays, constantStaysConstantAtEveryLevel) {
    for (const ColorSpace space : {ColorSpace::linear, ColorSpace::srgb})
        for (int code = 0; code < 256; code += 3) {
            const auto c = static_cast<std::uint8_t>(code);
            const Rgba color{c, std::uint8_t(255 - c), std::uint8_t(c / 2), std::uint8_t(c ^ 0x55)};
            const TextureArrays arrays = buildTextureArrays(sceneOf({plain(13, 6, color)}, space));
            ASSERT_EQ(arrays.arrays.at(0).mipLevels, 4u);
            for (std::uint8_t i = 0; const std::uint8_t texel : arrays.arrays[0].texels)
                EXPECT_EQ(texel, color[i++ % 4]) << "of " << code;
        }
}

TEST(TextureArrays, blackAndWhiteAverageInLinearLight) {
    const Image checker = image(8, 8, [](int x, int y) {
        const auto c = static_cast<std::uint8_t>((x + y) % 2 * 255);
        return Rgba{c, c, c, c};
    });
    for (const ColorSpace space : {ColorSpace::linear, ColorSpace::srgb}) {
        const TextureArrays arrays = buildTextureArrays(sceneOf({checker}, space));
        for (std::uint32_t mip = 1; mip < 4; ++mip) {
            const Level half = level(arrays, 0, mip);
            EXPECT_EQ(half.at(0, 0, 0), space == ColorSpace::srgb ? 188 : 128);
            EXPECT_EQ(half.at(0, 0, 3), 128);  // alpha is linear in both
        }
    }
}

TEST(TextureArrays, oddSizesHaveExactBoxWeights) {
    // 5 → 2: each target texel covers 2.5 source texels.
    const std::uint8_t row[5] = {10, 200, 90, 30, 250};
    const Image five = image(5, 1, [&](int x, int) { return Rgba{row[x], 0, 0, 255}; });
    const Level half = level(buildTextureArrays(sceneOf({five}, ColorSpace::linear)), 0, 1);
    ASSERT_EQ(half.width, 2);
    EXPECT_EQ(half.at(0, 0, 0), std::lround((10 + 200 + 0.5 * 90) / 2.5));
    EXPECT_EQ(half.at(1, 0, 0), std::lround((0.5 * 90 + 30 + 250) / 2.5));
}

TEST(TextureArrays, everyLevelKeepsTheMean) {
    for (const ColorSpace space : {ColorSpace::linear, ColorSpace::srgb})
        for (const auto& [width, height] : {std::pair(37, 21), std::pair(64, 1), std::pair(1, 1),
                                            std::pair(3, 50), std::pair(15, 15)}) {
            const Image original = noise(width, height, 7);
            const TextureArrays arrays = buildTextureArrays(sceneOf({original}, space));
            const std::uint32_t last = arrays.arrays[0].mipLevels - 1;
            const Level top = level(arrays, 0, last);
            ASSERT_EQ(top.rgba.size(), 4u);
            for (std::size_t channel = 0; channel < 4; ++channel) {
                const auto value = [&](int code) {
                    return space == ColorSpace::srgb && channel < 3 ? linearOf(code) : code / 255.0;
                };
                double mean = 0;
                for (std::size_t i = channel; i < original.rgba.size(); i += 4)
                    mean += value(original.rgba[i]);
                mean /= width * height;
                const int code = top.rgba[channel];
                // Within half a code, however many levels there were.
                EXPECT_GE(mean, code == 0 ? 0 : 0.5 * (value(code) + value(code - 1)) - 2e-3);
                EXPECT_LE(mean, code == 255 ? 1 : 0.5 * (value(code) + value(code + 1)) + 2e-3);
            }
        }
}

TEST(TextureArrays, levelZeroIsTheImageItself) {
    const std::vector<Image> images = {noise(16, 16, 1), noise(16, 16, 2), noise(9, 16, 3)};
    const TextureArrays arrays = buildTextureArrays(sceneOf(images, ColorSpace::srgb));
    ASSERT_EQ(arrays.arrays.size(), 2u);
    for (std::size_t i = 0; i < images.size(); ++i)
        EXPECT_EQ(level(arrays, i, 0).rgba, images[i].rgba);
}

TEST(TextureArrays, sameImageInOneColourSpaceIsStoredOnce) {
    Scene scene = sceneOf({noise(4, 4, 1)}, ColorSpace::srgb);
    scene.textures.push_back({0, ColorSpace::srgb, Wrap::clampToEdge, Wrap::clampToEdge, false});
    scene.textures.push_back({0, ColorSpace::linear});
    const TextureArrays arrays = buildTextureArrays(scene);
    ASSERT_EQ(arrays.arrays.size(), 2u);
    EXPECT_EQ(arrays.arrays[0].layers + arrays.arrays[1].layers, 2u);
    EXPECT_EQ(arrays.slotOf[0].array, arrays.slotOf[1].array);
    EXPECT_EQ(arrays.slotOf[0].layer, arrays.slotOf[1].layer);
    EXPECT_NE(arrays.slotOf[0].array, arrays.slotOf[2].array);
    EXPECT_EQ(arrays.arrays[arrays.slotOf[2].array].space, ColorSpace::linear);
}

TEST(TextureArrays, manySizesMergeUpwards) {
    std::vector<Image> images;
    for (int i = 0; i < 14; ++i)
        images.push_back(plain(4 + 3 * i, 60 - 4 * i, {std::uint8_t(10 * i), 7, 9, 200}));
    Scene scene = sceneOf(images, ColorSpace::srgb);
    for (std::uint32_t i = 0; i < 14; ++i) scene.textures.push_back({i, ColorSpace::linear});
    const TextureArrays arrays = buildTextureArrays(scene);
    EXPECT_LE(arrays.arrays.size(), kMaxTextureArrays);
    ASSERT_EQ(arrays.slotOf.size(), 28u);
    for (std::size_t i = 0; i < 28; ++i) {
        const TextureSlot slot = arrays.slotOf[i];
        ASSERT_LT(slot.array, arrays.arrays.size());
        const TextureArray& array = arrays.arrays[slot.array];
        ASSERT_LT(slot.layer, array.layers);
        EXPECT_EQ(array.space, scene.textures[i].space);
        EXPECT_GE(array.width, images[i % 14].width);
        EXPECT_GE(array.height, images[i % 14].height);
        for (std::uint32_t mip = 0; mip < array.mipLevels; ++mip) {
            const Level texels = level(arrays, i, mip);
            EXPECT_EQ(texels.at(0, 0, 0), int(10 * (i % 14)));
            EXPECT_EQ(texels.at(texels.width - 1, texels.height - 1, 3), 200);
        }
    }
}

TEST(TextureArrays, smallSizesMergeFirst) {
    std::vector<Image> images;
    for (const int size : {2, 4, 8, 16, 32, 64, 128, 256, 512})
        images.push_back(noise(size, size, 1));
    const TextureArrays arrays = buildTextureArrays(sceneOf(images, ColorSpace::linear));
    ASSERT_EQ(arrays.arrays.size(), 8u);
    EXPECT_EQ(arrays.slotOf[0].array, arrays.slotOf[1].array);
    EXPECT_EQ(arrays.arrays[arrays.slotOf[0].array].width, 4);
}

TEST(TextureArrays, enlargingIsBilinearAndWrapsAsTheTextureDoes) {
    // 2 → 4: the outer texels lie a quarter texel beyond the centres of the inner ones.
    std::vector<Image> images = {image(2, 1, [](int x, int) {
        return Rgba{std::uint8_t(x * 200), 0, 0, 255};
    })};
    images.push_back(plain(4, 1, {0, 0, 0, 0}));
    for (const int size : {32, 64, 128, 256, 512, 1024, 2048}) images.push_back(plain(size, 1, {}));
    const auto firstRow = [&](Wrap wrap, bool nearest) {
        Scene scene = sceneOf(images, ColorSpace::linear);
        scene.textures[0].wrapU = wrap;
        scene.textures[0].nearest = nearest;
        const Level texels = level(buildTextureArrays(scene), 0, 0);
        EXPECT_EQ(texels.width, 4);
        return std::vector<int>{texels.at(0, 0, 0), texels.at(1, 0, 0), texels.at(2, 0, 0),
                                texels.at(3, 0, 0)};
    };
    EXPECT_EQ(firstRow(Wrap::repeat, false), (std::vector{50, 50, 150, 150}));
    EXPECT_EQ(firstRow(Wrap::clampToEdge, false), (std::vector{0, 50, 150, 200}));
    EXPECT_EQ(firstRow(Wrap::mirroredRepeat, false), (std::vector{0, 50, 150, 200}));
    EXPECT_EQ(firstRow(Wrap::repeat, true), (std::vector{0, 0, 200, 200}));
}

TEST(TextureArrays, layersBeyondTheDeviceLimitGoToASecondArray) {
    std::vector<Image> images;
    for (int i = 0; i < 2050; ++i)
        images.push_back(plain(1, 1, {std::uint8_t(i), std::uint8_t(i >> 8), 0, 0}));
    const TextureArrays arrays = buildTextureArrays(sceneOf(images, ColorSpace::linear));
    ASSERT_EQ(arrays.arrays.size(), 2u);
    EXPECT_EQ(arrays.arrays[0].layers, 2048u);
    EXPECT_EQ(arrays.arrays[1].layers, 2u);
    for (std::size_t i = 0; i < images.size(); ++i)
        EXPECT_EQ(level(arrays, i, 0).rgba, images[i].rgba);
}

TEST(TextureArrays, sceneWithoutTexturesHasNone) {
    EXPECT_TRUE(buildTextureArrays({}).arrays.empty());
}

TEST(TextureArrays, imagesThatAreNotWhatTheySayAreRefused) {
    Scene scene = sceneOf({plain(4, 4, {})}, ColorSpace::srgb);
    scene.images[0].rgba.pop_back();
    EXPECT_THROW(buildTextureArrays(scene), std::invalid_argument);
    scene = sceneOf({plain(4, 4, {})}, ColorSpace::srgb);
    scene.textures[0].image = 1;
    EXPECT_THROW(buildTextureArrays(scene), std::invalid_argument);
}

}  // namespace
}  // namespace lodestar::scene

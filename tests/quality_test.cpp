// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <app/image_io.hpp>
#include <lodestar/quality/flicker.hpp>
#include <lodestar/quality/metrics.hpp>
#include <scenes.hpp>

namespace {

using namespace lodestar::quality;

RgbImage constant(int width, int height, int r, int g, int b) {
    RgbImage image(width, height);
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
        image.rgb[i] = std::uint8_t(r);
        image.rgb[i + 1] = std::uint8_t(g);
        image.rgb[i + 2] = std::uint8_t(b);
    }
    return image;
}

RgbImage noise(int width, int height, unsigned seed) {
    RgbImage image(width, height);
    std::mt19937 random(seed);
    for (std::uint8_t& code : image.rgb) code = std::uint8_t(random());
    return image;
}

/// A flat grey picture with one square of another grey in the middle.
RgbImage square(int size, int background, int foreground) {
    RgbImage image = constant(size, size, background, background, background);
    for (int y = size / 3; y < 2 * size / 3; ++y)
        for (int x = size / 3; x < 2 * size / 3; ++x)
            for (int channel = 0; channel < 3; ++channel)
                image.at(x, y)[channel] = std::uint8_t(foreground);
    return image;
}

TEST(Psnr, identicalImagesAreInfinite) {
    EXPECT_EQ(psnr(noise(17, 33, 1), noise(17, 33, 1)), std::numeric_limits<double>::infinity());
}

TEST(Psnr, isTheLogarithmOfTheMeanSquaredError) {
    EXPECT_NEAR(psnr(constant(3, 5, 10, 20, 30), constant(3, 5, 11, 19, 31)), 48.1308, 1e-4);
    // One code of 75 is off by 255: mse = 255² / 75.
    RgbImage test(5, 5);
    test.rgb[40] = 255;
    EXPECT_NEAR(psnr(RgbImage(5, 5), test), 10 * std::log10(75.0), 1e-9);
}

TEST(Psnr, maskLeavesOutTheOtherPixels) {
    const RgbImage reference = constant(4, 1, 100, 100, 100);
    RgbImage test = constant(4, 1, 101, 101, 101);
    test.at(3, 0)[1] = 255;
    EXPECT_NEAR(psnr(reference, test, {1, 255, 1, 0}), 48.1308, 1e-4);
    EXPECT_LT(psnr(reference, test, {0, 0, 0, 1}), 10);
    EXPECT_EQ(psnr(reference, test, {1, 1, 1, 1}), psnr(reference, test));
    EXPECT_TRUE(std::isnan(psnr(reference, test, {0, 0, 0, 0})));
    EXPECT_THROW(psnr(reference, test, {1, 1, 1}), std::invalid_argument);
}

TEST(Ssim, identicalImagesAreOne) {
    EXPECT_DOUBLE_EQ(ssim(noise(40, 300, 1), noise(40, 300, 1)), 1);
}

TEST(Ssim, constantImagesDifferInLuminanceOnly) {
    const double c1 = 2.55 * 2.55, a = 50, b = 200;
    EXPECT_NEAR(ssim(constant(12, 300, 50, 50, 50), constant(12, 300, 200, 200, 200)),
                (2 * a * b + c1) / (a * a + b * b + c1), 1e-9);
}

TEST(Ssim, seesOnlyTheRec601Luma) {
    const double luma = 0.299 * 200 + 0.587 * 10 + 0.114 * 77, c1 = 2.55 * 2.55;
    EXPECT_NEAR(ssim(constant(11, 11, 200, 10, 77), RgbImage(11, 11)), c1 / (luma * luma + c1),
                1e-9);
}

TEST(Ssim, invertedNoiseIsNegative) {
    const RgbImage reference = noise(64, 64, 3);
    RgbImage test = reference;
    for (std::uint8_t& code : test.rgb) code = std::uint8_t(255 - code);
    EXPECT_LT(ssim(reference, test), -0.8);
}

TEST(Ssim, ignoresBordersOfFivePixelsOnlyAsWindowCentres) {
    // The single window of an 11 × 11 picture reaches its corner.
    RgbImage test = constant(11, 11, 9, 9, 9);
    test.at(0, 0)[1] = 255;
    EXPECT_LT(ssim(constant(11, 11, 9, 9, 9), test), 1);
    EXPECT_THROW(ssim(RgbImage(10, 11), RgbImage(10, 11)), std::invalid_argument);
    EXPECT_THROW(ssim(RgbImage(11, 10), RgbImage(11, 10)), std::invalid_argument);
}

TEST(Flip, identicalImagesAreZeroEverywhere) {
    for (float error : flipMap(noise(17, 133, 5), noise(17, 133, 5)).values) ASSERT_EQ(error, 0);
}

TEST(Flip, constantImagesFollowTheColorErrorAlone) {
    // No edges and nothing to filter. Green and blue are as far apart as colours get.
    EXPECT_NEAR(flip(constant(9, 5, 0, 255, 0), constant(9, 5, 0, 0, 255)), 1, 1e-4);
    // Black and white: HyAB = 100; the largest HyAB to the power of 0.7 is 41.276.
    const double largest = 41.276, power = std::pow(100, 0.7);
    EXPECT_NEAR(flip(RgbImage(9, 5), constant(9, 5, 255, 255, 255)),
                0.95 + 0.05 * (power - 0.4 * largest) / (0.6 * largest), 1e-4);
    // Black and code 119: L* = 50.034 by the definition of CIE L*a*b*, below the knee.
    EXPECT_NEAR(flip(RgbImage(9, 5), constant(9, 5, 119, 119, 119)),
                0.95 * std::pow(50.034, 0.7) / (0.4 * largest), 1e-3);
}

TEST(Flip, isSymmetric) {
    const RgbImage a = noise(30, 70, 7), b = noise(30, 70, 8);
    const ScalarImage ab = flipMap(a, b), ba = flipMap(b, a);
    EXPECT_EQ(ab.width, 30);
    EXPECT_EQ(ab.height, 70);
    EXPECT_EQ(ab.values, ba.values);
}

TEST(Flip, followsAMirroredAndATurnedPicture) {
    // Taller than one band, so that seams between bands would show.
    const RgbImage a = noise(40, 150, 9), b = noise(40, 150, 10);
    const auto mirrored = [](const RgbImage& in) {
        RgbImage out(in.width, in.height);
        for (int y = 0; y < in.height; ++y)
            for (int x = 0; x < in.width; ++x)
                std::copy_n(in.at(x, y), 3, out.at(in.width - 1 - x, in.height - 1 - y));
        return out;
    };
    const auto turned = [](const RgbImage& in) {
        RgbImage out(in.height, in.width);
        for (int y = 0; y < in.height; ++y)
            for (int x = 0; x < in.width; ++x) std::copy_n(in.at(x, y), 3, out.at(y, x));
        return out;
    };
    const ScalarImage plain = flipMap(a, b), mirror = flipMap(mirrored(a), mirrored(b)),
                      turn = flipMap(turned(a), turned(b));
    for (int y = 0; y < 150; ++y)
        for (int x = 0; x < 40; ++x) {
            const float expected = plain.values[y * 40 + x];
            ASSERT_NEAR(mirror.values[(149 - y) * 40 + 39 - x], expected, 1e-3);
            ASSERT_NEAR(turn.values[x * 150 + y], expected, 1e-3);
        }
}

TEST(Flip, aLostEdgeCountsMoreThanItsColorAlone) {
    // The same difference in code, with and without edges around it.
    const double withEdges =
        flipMap(square(90, 100, 110), square(90, 100, 100)).values[45 * 90 + 30];
    const double without = flip(constant(9, 9, 110, 110, 110), constant(9, 9, 100, 100, 100));
    EXPECT_GT(withEdges, without);
}

TEST(Metrics, refuseWhatCannotBeCompared) {
    const RgbImage a(20, 20), narrow(19, 20), low(20, 19), empty;
    RgbImage lying(20, 20);
    lying.rgb.pop_back();
    for (const RgbImage& b : {narrow, low, empty, lying}) {
        EXPECT_THROW(psnr(a, b), std::invalid_argument);
        EXPECT_THROW(psnr(b, a, std::vector<std::uint8_t>(400, 1)), std::invalid_argument);
        EXPECT_THROW(ssim(a, b), std::invalid_argument);
        EXPECT_THROW(flip(b, a), std::invalid_argument);
    }
    EXPECT_THROW(psnr(empty, empty), std::invalid_argument);
    EXPECT_THROW(flipMap(empty, empty), std::invalid_argument);
    EXPECT_THROW(falseColor({2, 2, {0, 0, 0}}), std::invalid_argument);
}

TEST(FalseColor, runsFromBlackThroughPurpleToPaleYellow) {
    const float beyond = std::numeric_limits<float>::infinity();
    const RgbImage colors = falseColor({7, 1, {0, 1, 0.2f, 7.0f / 255, -1, beyond, std::nanf("")}});
    const auto color = [&](int x) {
        return colors.at(x, 0)[0] << 16 | colors.at(x, 0)[1] << 8 | colors.at(x, 0)[2];
    };
    EXPECT_EQ(color(0), 0x000004);
    EXPECT_EQ(color(1), 0xfcfdbf);
    EXPECT_EQ(color(2), 0x3b0f70);
    // Between two stops: the colour map itself has 0x030312 … 0x040414 here.
    EXPECT_NEAR(color(3) >> 16, 4, 3);
    EXPECT_NEAR(color(3) & 0xff, 0x13, 3);
    EXPECT_EQ(color(4), color(0));
    EXPECT_EQ(color(5), color(1));
    EXPECT_EQ(color(6), color(0));
}

RgbImage shiftedRight(const RgbImage& image, int by) {
    RgbImage out = image;
    for (int y = 0; y < image.height; ++y)
        for (int x = by; x < image.width; ++x) std::copy_n(image.at(x - by, y), 3, out.at(x, y));
    return out;
}

MotionField uniformMotion(int width, int height, float x, float y) {
    MotionField motion{width, height, {}};
    for (int i = 0; i < width * height; ++i) motion.offsets.insert(motion.offsets.end(), {x, y});
    return motion;
}

TEST(Flicker, aConstantErrorIsNone) {
    EXPECT_EQ(flicker(constant(5, 4, 10, 20, 30), constant(5, 4, 40, 50, 60),
                      constant(5, 4, 15, 25, 35), constant(5, 4, 45, 55, 65)),
              0);
}

TEST(Flicker, isTheChangeThatTheReferenceHasNot) {
    const RgbImage still = constant(5, 4, 100, 100, 100);
    RgbImage blink = still;
    blink.at(2, 2)[1] = 151;  // by 51 of 255 in one of 60 codes
    EXPECT_NEAR(flicker(still, still, still, blink), 0.2 / 60, 1e-9);
    EXPECT_NEAR(flicker(still, still, blink, still), 0.2 / 60, 1e-9);
    EXPECT_NEAR(flicker(still, blink, still, still), 0.2 / 60, 1e-9);
    EXPECT_EQ(flicker(still, blink, still, blink), 0);
}

TEST(Flicker, motionIsFollowed) {
    // The reference is flat; the test's error is noise that sticks to the moving surface.
    const RgbImage flat = constant(20, 10, 128, 128, 128), before = noise(20, 10, 4);
    const RgbImage now = shiftedRight(before, 3);
    const MotionField motion = uniformMotion(20, 10, -3, 0);
    EXPECT_GT(flicker(flat, flat, before, now), 0.1);
    EXPECT_EQ(flicker(flat, flat, before, now, &motion), 0);
}

TEST(Flicker, halfPixelsAreInterpolated) {
    RgbImage ramp(8, 8), shifted(8, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            for (int channel = 0; channel < 3; ++channel) {
                ramp.at(x, y)[channel] = std::uint8_t(20 * x + 8 * y);
                shifted.at(x, y)[channel] = std::uint8_t(20 * x + 8 * y - 10 - 2);
            }
    const RgbImage flat(8, 8);
    const MotionField motion = uniformMotion(8, 8, -0.5f, -0.25f);
    EXPECT_NEAR(flicker(flat, flat, ramp, shifted, &motion), 0, 1e-6);
}

TEST(Flicker, whatWasNotVisibleIsLeftOut) {
    const RgbImage flat(4, 2), test = constant(4, 2, 51, 51, 51);
    MotionField motion = uniformMotion(4, 2, std::nanf(""), 0);
    EXPECT_TRUE(std::isnan(flicker(flat, flat, flat, test, &motion)));
    motion.offsets[0] = 0;
    EXPECT_NEAR(flicker(flat, flat, flat, test, &motion), 0.2, 1e-9);
    motion = uniformMotion(4, 2, 1e30f, 0);
    EXPECT_TRUE(std::isnan(flicker(flat, flat, flat, test, &motion)));
    motion.offsets.pop_back();
    EXPECT_THROW(flicker(flat, flat, flat, test, &motion), std::invalid_argument);
    EXPECT_THROW(flicker(flat, flat, flat, RgbImage(2, 4)), std::invalid_argument);
}

TEST(Metrics, agreeWithTheirReferenceImplementations) {
    REQUIRE_SCENES();
    const std::filesystem::path folder = scenesFolder() / ".." / "quality";
    std::ifstream file(folder / "expected.json");
    ASSERT_TRUE(file) << "no expected.json in " << folder;
    const nlohmann::json expected = nlohmann::json::parse(file);
    ASSERT_GE(expected.at("pairs").size(), 6u);
    for (const nlohmann::json& pair : expected.at("pairs")) {
        const auto load = [&](const char* key) {
            return lodestar::app::readImage(folder / pair.at(key).get<std::string>());
        };
        const auto reference = load("reference"), test = load("test");
        ASSERT_TRUE(reference) << reference.error().message;
        ASSERT_TRUE(test) << test.error().message;
        SCOPED_TRACE(pair.at("test").get<std::string>());
        if (pair.at("psnr_db").is_null())
            EXPECT_EQ(psnr(*reference, *test), std::numeric_limits<double>::infinity());
        else
            EXPECT_NEAR(psnr(*reference, *test), pair.at("psnr_db").get<double>(), 0.01);
        EXPECT_NEAR(ssim(*reference, *test), pair.at("ssim_luma").get<double>(), 0.001);
        EXPECT_NEAR(flip(*reference, *test), pair.at("flip_mean").get<double>(), 0.001);
    }
}

}  // namespace

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <lodestar/quality/metrics.hpp>

#include "app/image_io.hpp"
#include "gpu_device.hpp"

/// Compares a picture with tests/golden/NAME.png. It may differ by 2 codes anywhere, by more in at
/// most 1 % of its pixels, and nowhere by more than 48 codes: compilers and vector widths round
/// differently, which moves an edge pixel here and there. What fails is written to the working
/// folder, with a picture of the differences. With LODESTAR_UPDATE_GOLDEN=1 in the environment the
/// file is written instead: look at it before committing it. On another driver than that of the
/// golden pictures, which filters textures and rounds its own way, 35 dB must do.
inline void expectGolden(const lodestar::quality::RgbImage& picture, const std::string& name) {
    namespace app = lodestar::app;
    constexpr int kSame = 2, kMost = 48;
    constexpr double kElsewhereDb = 35;
    const auto golden =
        std::filesystem::path(LODESTAR_SOURCE_DIR) / "tests" / "golden" / (name + ".png");
    if (std::getenv("LODESTAR_UPDATE_GOLDEN")) {
        const auto written = app::writePng(golden, picture);
        ASSERT_TRUE(written) << written.error().message;
        return;
    }
    const auto expected = app::readImage(golden);
    ASSERT_TRUE(expected) << expected.error().message;
    ASSERT_EQ(expected->width, picture.width);
    ASSERT_EQ(expected->height, picture.height);

    lodestar::quality::ScalarImage error{picture.width, picture.height, {}};
    int most = 0, unlike = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3) {
        int difference = 0;
        for (std::size_t c = i; c < i + 3; ++c)
            difference =
                std::max(difference, std::abs(int(picture.rgb[c]) - int(expected->rgb[c])));
        most = std::max(most, difference);
        unlike += difference > kSame;
        error.values.push_back(std::min(1.0f, float(difference) / kMost));
    }
    const auto pixels = static_cast<int>(error.values.size());
    const double psnr = lodestar::quality::psnr(*expected, picture);
    const bool alike =
        onReferenceDriver() ? most <= kMost && unlike <= pixels / 100 : psnr > kElsewhereDb;
    EXPECT_TRUE(alike) << unlike << " of " << pixels << " pixels differ, by up to " << most
                       << " codes: " << psnr << " dB";
    if (!alike) {
        for (const auto& [suffix, image] :
             {std::pair{"actual", picture},
              std::pair{"difference", lodestar::quality::falseColor(error)}}) {
            const auto path = std::filesystem::absolute("golden_" + name + "_" + suffix + ".png");
            if (app::writePng(path, image)) ADD_FAILURE() << "see " << path;
        }
    }
}

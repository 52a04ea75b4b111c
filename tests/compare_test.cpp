// SPDX-License-Identifier: Apache-2.0
#include "app/compare.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <app/image_io.hpp>
#include <lodestar/quality/metrics.hpp>
#include <temp_folder.hpp>

namespace {

using namespace lodestar;
using quality::RgbImage;

struct Outcome {
    int exitCode;
    std::string out, error;
};

/// Runs `lodestar compare ARGUMENTS` as main() would.
Outcome run(std::vector<std::string> arguments) {
    CLI::App program;
    int exitCode = -1;
    app::addCompare(program, exitCode);
    arguments.insert(arguments.begin(), "compare");
    std::reverse(arguments.begin(), arguments.end());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    program.parse(arguments);
    std::fflush(nullptr);
    return {exitCode, testing::internal::GetCapturedStdout(),
            testing::internal::GetCapturedStderr()};
}

RgbImage stripes(int width, int height, int contrast) {
    RgbImage image(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int channel = 0; channel < 3; ++channel)
                image.at(x, y)[channel] = std::uint8_t(100 + (x / 4 % 2) * contrast + channel * y);
    return image;
}

void expectOneLine(const std::string& error) {
    EXPECT_EQ(error.rfind("lodestar: error: ", 0), 0u) << error;
    EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
}

TEST(Compare, reportsTheFiguresOfTheLibrary) {
    const TempFolder folder;
    const RgbImage reference = stripes(40, 30, 60), test = stripes(40, 30, 50);
    const std::string referencePath = (folder / "a ref.png").string();
    const std::string testPath = (folder / "b.png").string();
    ASSERT_TRUE(app::writePng(referencePath, reference));
    ASSERT_TRUE(app::writePng(testPath, test));
    const Outcome outcome = run({referencePath, testPath, "--out", (folder / "map.png").string(),
                                 "--json", (folder / "figures.json").string()});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.error;
    EXPECT_EQ(outcome.error, "");
    EXPECT_NE(outcome.out.find("31.14 dB"), std::string::npos) << outcome.out;  // half off by 10
    EXPECT_NE(outcome.out.find("40 x 30"), std::string::npos) << outcome.out;

    const nlohmann::json figures = nlohmann::json::parse(folder.read("figures.json"));
    EXPECT_EQ(figures.at("psnr_db").get<double>(), quality::psnr(reference, test));
    EXPECT_EQ(figures.at("ssim").get<double>(), quality::ssim(reference, test));
    EXPECT_EQ(figures.at("flip_mean").get<double>(), quality::flip(reference, test));
    EXPECT_EQ(figures.at("width"), 40);
    EXPECT_EQ(figures.at("height"), 30);
    EXPECT_EQ(figures.at("reference"), referencePath);
    EXPECT_EQ(figures.at("test"), testPath);
    EXPECT_EQ(figures.at("lodestar"), LODESTAR_VERSION);
    EXPECT_EQ(figures.at("quality").at("psnr_db"), figures.at("psnr_db"));
    for (const char* key : {"device", "driver", "scene", "settings", "passes", "counts", "memory"})
        EXPECT_TRUE(figures.contains(key)) << key;  // as of every command

    const auto map = app::readImage(folder / "map.png");
    ASSERT_TRUE(map) << map.error().message;
    EXPECT_EQ(map->rgb, quality::falseColor(quality::flipMap(reference, test)).rgb);
}

TEST(Compare, identicalPicturesHaveNoPsnr) {
    const TempFolder folder;
    const std::string path = (folder / "a.png").string();
    ASSERT_TRUE(app::writePng(path, stripes(16, 16, 9)));
    const Outcome outcome = run({path, path, "--json", (folder / "figures.json").string()});
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_NE(outcome.out.find("identical"), std::string::npos);
    const nlohmann::json figures = nlohmann::json::parse(folder.read("figures.json"));
    EXPECT_TRUE(figures.at("psnr_db").is_null());
    EXPECT_EQ(figures.at("ssim"), 1);
    EXPECT_EQ(figures.at("flip_mean"), 0);
}

TEST(Compare, picturesUnderTheSsimWindowStillGetTheRest) {
    const TempFolder folder;
    ASSERT_TRUE(app::writePng(folder / "a.png", stripes(5, 40, 60)));
    ASSERT_TRUE(app::writePng(folder / "b.png", stripes(5, 40, 61)));
    const Outcome outcome = run({(folder / "a.png").string(), (folder / "b.png").string(), "--json",
                                 (folder / "figures.json").string()});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.error;
    const nlohmann::json figures = nlohmann::json::parse(folder.read("figures.json"));
    EXPECT_TRUE(figures.at("ssim").is_null());
    EXPECT_GT(figures.at("flip_mean").get<double>(), 0);
}

TEST(Compare, pngAndExrOfOnePictureAreEqual) {
    const TempFolder folder;
    RgbImage white(12, 12);
    white.rgb.assign(white.rgb.size(), 255);
    ASSERT_TRUE(app::writePng(folder / "a.png", white));
    ASSERT_TRUE(app::writeExr(folder / "b.exr", 12, 12, {{"Y", std::vector<float>(144, 1.5f)}}));
    const Outcome outcome = run({(folder / "a.png").string(), (folder / "b.exr").string()});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.error;
    EXPECT_NE(outcome.out.find("identical"), std::string::npos) << outcome.out;
}

TEST(Compare, failuresAreOneLineAndLeaveNoOutputs) {
    const TempFolder folder;
    const std::string a = (folder / "a.png").string(), b = (folder / "b.png").string();
    ASSERT_TRUE(app::writePng(a, stripes(20, 12, 60)));
    ASSERT_TRUE(app::writePng(b, stripes(12, 20, 60)));
    const std::string json = (folder / "figures.json").string();

    Outcome outcome = run({a, b, "--json", json});
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_EQ(outcome.out, "");
    expectOneLine(outcome.error);
    EXPECT_NE(outcome.error.find("a.png is 20 x 12 but"), std::string::npos) << outcome.error;

    outcome = run({a, (folder / "none.png").string(), "--json", json});
    EXPECT_EQ(outcome.exitCode, 1);
    expectOneLine(outcome.error);
    EXPECT_NE(outcome.error.find("none.png"), std::string::npos) << outcome.error;
    EXPECT_EQ(folder.fileCount(), 2);

    outcome = run({a, a, "--out", (folder / "no/folder.png").string()});
    EXPECT_EQ(outcome.exitCode, 1);
    expectOneLine(outcome.error);
}

TEST(Compare, refusesToOverwriteItsInputs) {
    const TempFolder folder;
    const std::string a = (folder / "a.png").string();
    ASSERT_TRUE(app::writePng(a, stripes(20, 12, 60)));
    const std::string before = folder.read("a.png");
    const Outcome outcome = run({a, a, "--out", (folder / "./a.png").string()});
    EXPECT_EQ(outcome.exitCode, 1);
    expectOneLine(outcome.error);
    EXPECT_EQ(folder.read("a.png"), before);
}

TEST(Compare, needsTwoPictures) {
    CLI::App program;
    int exitCode = -1;
    app::addCompare(program, exitCode);
    std::vector<std::string> arguments = {"a.png", "compare"};
    EXPECT_THROW(program.parse(arguments), CLI::ParseError);
    EXPECT_EQ(exitCode, -1);
}

}  // namespace

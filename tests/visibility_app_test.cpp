// SPDX-License-Identifier: Apache-2.0
// The commands and benches of captured visibility.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "app/bench/bench.hpp"
#include "app/bench/deferred.hpp"
#include "app/bench/visibility_cases.hpp"
#include "app/image_io.hpp"
#include "gpu_device.hpp"
#include "temp_folder.hpp"

namespace lodestar::app {
namespace {

struct Ended {
    int status = 0;
    std::string out, err;
};

std::string contents(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

/// The program itself on Mesa's CPU driver.
Ended run(const TempFolder& folder, const std::string& arguments,
          const std::string& environment = "") {
    const auto out = folder / "stdout", err = folder / "stderr";
    const std::string command = environment + " \"" LODESTAR_PROGRAM "\" " + arguments +
                                " --device " + testDevice() + " > \"" + out.string() + "\" 2> \"" +
                                err.string() + "\"";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out), contents(err)};
}

std::string quoted(const std::filesystem::path& path) {
    return "\"" + path.string() + "\"";
}

void expectOneErrorLine(const Ended& ended, int status) {
    EXPECT_EQ(ended.status, status) << ended.err;
    EXPECT_TRUE(ended.err.starts_with("lodestar: error: ")) << ended.err;
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
}

TEST(CaptureProgram, aCapturedFrameIsRebuiltAsDirectRenderingShowsIt) {
    const TempFolder folder;
    const auto stream = folder / "f.lvis", json = folder / "f.json", png = folder / "f.png";
    const Ended captured =
        run(folder,
            "capture builtin:spheres --camera 1 --size 20x14 --capture-rate 64 --capture ss "
            "--validate --out " +
                quoted(stream) + " --json " + quoted(json));
    ASSERT_EQ(captured.status, 0) << captured.err;
    const Json report = Json::parse(contents(json));
    EXPECT_EQ(report.at("settings").at("capture"), "ss");
    EXPECT_EQ(report.at("stream").at("file_bytes"), std::filesystem::file_size(stream));
    EXPECT_GT(report.at("counts").at("list_nodes"), 100);

    const std::string rebuild = "rebuild " + quoted(stream) + " builtin:spheres --validate --out " +
                                quoted(png) + " --json " + quoted(json);
    const Ended rebuilt = run(folder, rebuild + " --reference");
    ASSERT_EQ(rebuilt.status, 0) << rebuilt.err;
    EXPECT_EQ(Json::parse(contents(json)).at("quality").at("identical"), true);
    EXPECT_EQ(readImage(png)->width, 160);
    ASSERT_EQ(run(folder, rebuild + " --size 63x44 --shading-rate 2").status, 0);
    EXPECT_EQ(readImage(png)->height, 44);
    ASSERT_EQ(run(folder, rebuild + " --antialias").status, 0);
    EXPECT_EQ(readImage(png)->width, 20);

    expectOneErrorLine(run(folder, rebuild + " --antialias --size 21x14"), 1);
    const Ended other = run(
        folder, "rebuild " + quoted(stream) + " builtin:columns --out " + quoted(folder / "x.png"));
    expectOneErrorLine(other, 1);
    EXPECT_NE(other.err.find("captured from 'builtin:spheres'"), std::string::npos) << other.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "x.png"));

    std::filesystem::resize_file(stream, 300);
    expectOneErrorLine(run(folder, rebuild), 1);
}

TEST(CaptureProgram, whatCannotBeIsRefusedInALine) {
    const TempFolder folder;
    const std::string to = " --out " + quoted(folder / "f.lvis");
    expectOneErrorLine(run(folder, "capture builtin:spheres --capture-rate 9" + to), 2);
    expectOneErrorLine(run(folder, "capture builtin:spheres --capture maybe" + to), 2);
    expectOneErrorLine(run(folder, "capture builtin:spheres --size 4096x16 --capture-rate 64" + to),
                       1);
    expectOneErrorLine(run(folder, "rebuild " + quoted(folder / "none.lvis") +
                                       " builtin:spheres --out " + quoted(folder / "x.png")),
                       1);
}

TEST(CaptureProgram, computeGivesTheSameBytesOnAnyNumberOfThreads) {
    const TempFolder folder;
    std::string first;
    for (const char* threads : {"1", "2", "5"}) {
        const auto stream = folder / (std::string(threads) + ".lvis");
        const Ended ended = run(folder,
                                "capture builtin:columns --camera 1 --size 75x47 --capture-rate 16 "
                                "--capture compute --out " +
                                    quoted(stream),
                                std::string("LP_NUM_THREADS=") + threads);
        ASSERT_EQ(ended.status, 0) << ended.err;
        const std::string bytes = contents(stream);
        EXPECT_GT(bytes.size(), 5000u);
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first) << threads << " threads";
    }
}

TEST(RenderProgram, severalSamplesAPixelGiveAnAntialiasedPicture) {
    const TempFolder folder;
    const auto png = folder / "f.png", json = folder / "f.json";
    const std::string render =
        "render builtin:spheres --camera 1 --size 40x28 --lod off --out " + quoted(png);
    ASSERT_EQ(run(folder, render).status, 0);
    const auto plain = readImage(png);
    const Ended smooth =
        run(folder, render + " --capture-rate 16 --capture ss --validate --aov depth,id --json " +
                        quoted(json));
    ASSERT_EQ(smooth.status, 0) << smooth.err;
    const Json report = Json::parse(contents(json));
    EXPECT_EQ(report.at("settings").at("capture_rate"), 16);
    EXPECT_GT(report.at("counts").at("triangles_visible"), 100);
    EXPECT_NE(readImage(png)->rgb, plain->rgb);
    // The same as a stream, rebuilt.
    const auto stream = folder / "f.lvis", other = folder / "g.png";
    ASSERT_EQ(run(folder, "capture builtin:spheres --camera 1 --size 40x28 --capture ss --out " +
                              quoted(stream))
                  .status,
              0);
    ASSERT_EQ(run(folder, "rebuild " + quoted(stream) + " builtin:spheres --antialias --out " +
                              quoted(other))
                  .status,
              0);
    EXPECT_EQ(readImage(png)->rgb, readImage(other)->rgb);

    expectOneErrorLine(run(folder, render + " --capture-rate 16 --shading-rate 2"), 1);
    expectOneErrorLine(run(folder, render + " --capture-rate 4 --budget 50%"), 1);
    expectOneErrorLine(run(folder, render + " --capture ms"), 1);
    expectOneErrorLine(run(folder, render + " --capture-rate 3"), 2);
}

BenchOptions quickOptions(const TempFolder& folder) {
    BenchOptions options{.out = folder / "out",
                         .device = {.device = testDevice(), .validation = true}};
    makeQuick(options);
    options.rounds = 1;
    return options;
}

const Json& bar(const Json& result, const std::string& words) {
    for (const Json& one : result.at("bars"))
        if (one.at("what").get<std::string>().starts_with(words)) return one;
    throw std::runtime_error("no bar '" + words + "'");
}

TEST(VisibilityQualityBench, idsAreThoseOfDirectRaster) {
    const TempFolder folder;
    const auto result = runBench("visibility-quality", quickOptions(folder));
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_TRUE(bar(*result, "ids of direct raster: builtin:columns qHD/4 ss").at("holds"));
    EXPECT_TRUE(bar(*result, "ids of direct raster: builtin:columns qHD/4 compute").at("holds"));
    EXPECT_GT(bar(*result, "ids of supersampling").at("value"), 98);
    EXPECT_GT(bar(*result, "albedo").at("value"), 45);
    EXPECT_GT(bar(*result, "depth").at("value"), 90);
    EXPECT_EQ(result->at("source").size(), 12u + 20u);
}

TEST(VisibilityMemoryBench, theRecordIsSmallerThanTheThesisLayout) {
    const TempFolder folder;
    const auto result = runBench("visibility-memory", quickOptions(folder));
    ASSERT_TRUE(result) << result.error().message;
    const Json& row = result->at("rows").at(0);
    EXPECT_EQ(row.at("total_bytes"),
              row.at("heads_bytes").get<int>() + row.at("list_bytes").get<int>());
    EXPECT_LT(row.at("of_thesis_share"), 0.8);
    EXPECT_LT(row.at("lvis_of_thesis_share"), 0.3);
    EXPECT_EQ(result->at("source").size(), 12u);
}

TEST(VisibilityTimeBench, comparesEveryBackendWithTheReference) {
    const TempFolder folder;
    const auto result = runBench("visibility-time", quickOptions(folder));
    ASSERT_TRUE(result) << result.error().message;
    std::vector<std::string> methods;
    for (const Json& row : result->at("rows")) {
        methods.push_back(row.at("method"));
        EXPECT_GT(row.at("total_ms"), 0);
        EXPECT_NEAR(row.at("total_ms").get<double>(),
                    row.at("sampling_ms").get<double>() + row.at("shading_ms").get<double>(), 1e-6);
    }
    EXPECT_EQ(methods, (std::vector<std::string>{"compute", "ss", "ms", "ref"}));
    EXPECT_EQ(result->at("bars").size(), 1u);
    EXPECT_EQ(result->at("source").size(), 4u * 3 * 4);
}

}  // namespace
}  // namespace lodestar::app

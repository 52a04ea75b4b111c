// SPDX-License-Identifier: Apache-2.0
// Automatic selection of what is resized, and the benches of Yang et al. 2008.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>

#include <gtest/gtest.h>

#include "app/bench/bench.hpp"
#include "app/bench/motion.hpp"
#include "app/bench/paper_scenes.hpp"
#include "app/frame_options.hpp"
#include "app/image_io.hpp"
#include "app/tune.hpp"
#include "gpu_device.hpp"
#include "temp_folder.hpp"

namespace lodestar::app {
namespace {

std::string contents(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

/// The program itself on Mesa's CPU driver: its exit status and what it wrote to standard error.
std::pair<int, std::string> run(const TempFolder& folder, const std::string& arguments) {
    const auto out = folder / "stdout", err = folder / "stderr";
    const std::string command = "\"" LODESTAR_PROGRAM "\" " + arguments + " --device " +
                                testDevice() + " > \"" + out.string() + "\" 2> \"" + err.string() +
                                "\"";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(err)};
}

TEST(Calibrate, writesRatesThatRenderTakes) {
    const TempFolder folder;
    const std::string settings = (folder / "s.json").string(), png = (folder / "p.png").string(),
                      report = (folder / "r.json").string();
    const std::string scene = " builtin:columns --size 96x64 --terms shadow,ao,noise ";
    auto [status, error] = run(folder, "calibrate" + scene + "--rounds 1 --budget 70% --views 2 " +
                                           "--path orbit:20 --validate --out " + settings);
    ASSERT_EQ(status, 0) << error;
    const Json tuned = Json::parse(contents(settings));
    EXPECT_EQ(tuned.at("term_ms").size(), 3u);
    EXPECT_NEAR(tuned.at("budget_ms").get<double>(), 0.7 * tuned.at("full_ms").get<double>(), 1e-9);
    EXPECT_EQ(tuned.at("samples").size(), 1u + 2 * (3 * 6 + 2 + 2));
    for (const Json& other : tuned.at("finalists")) EXPECT_TRUE(other.contains("predicted_ms"));

    std::tie(status, error) = run(folder, "render" + scene + "--settings " + settings + " --out " +
                                              png + " --json " + report);
    ASSERT_EQ(status, 0) << error;
    const Json used = Json::parse(contents(report)).at("settings");
    for (const char* term : {"shadow", "ao", "noise"})
        EXPECT_NEAR(used.at("rates").at(term).get<double>(),
                    tuned.at("rates").at(term).get<double>(), 1e-4);
    EXPECT_EQ(used.at("repair"), tuned.at("repair"));
}

TEST(Calibrate, renderDoesItInAWarmUp) {
    const TempFolder folder;
    const std::string png = (folder / "p.png").string(), report = (folder / "r.json").string();
    const auto [status, error] = run(
        folder, "render builtin:columns --size 64x48 --auto --budget 60% --controller none --out " +
                    png + " --json " + report);
    ASSERT_EQ(status, 0) << error;
    const Json json = Json::parse(contents(report));
    EXPECT_EQ(json.at("auto").at("rates").at("shadow"),
              json.at("settings").at("rates").at("shadow"));
    EXPECT_EQ(readImage(png)->width, 64);
}

TEST(Calibrate, badUseIsRefusedWithOneLine) {
    const TempFolder folder;
    const std::string out = " --out " + (folder / "p.png").string();
    EXPECT_EQ(run(folder, "render builtin:columns --auto" + out).first, 2)
        << "--auto wants a budget";
    EXPECT_EQ(run(folder, "render builtin:columns --settings x --shading-rate 2" + out).first, 2);
    EXPECT_EQ(run(folder, "calibrate builtin:columns --size 32x32 --terms none" + out).first, 1);
    const auto [status, error] =
        run(folder, "render builtin:columns --settings nothing.json" + out);
    EXPECT_EQ(status, 1);
    EXPECT_NE(error.find("nothing.json: cannot be read"), std::string::npos) << error;
}

TEST(LeverOptions, allOfThemReachTheFrameInAnyOrder) {
    const TempFolder folder;
    const std::string report = (folder / "r.json").string();
    const std::string command = "render builtin:spheres --size 48x32 --out " +
                                (folder / "p.png").string() + " --json " + report;
    const auto settingsOf = [&](const std::string& options) {
        const auto [status, error] = run(folder, command + options);
        EXPECT_EQ(status, 0) << error;
        return Json::parse(contents(report)).at("settings");
    };
    const Json a = settingsOf(" --local-rate --shading-rate shadow=4,ao=2 --repair 0.05");
    EXPECT_NEAR(a.at("local_rate").get<double>(), kLocalRate, 1e-6);
    EXPECT_NEAR(a.at("repair").get<double>(), 0.05, 1e-6);
    EXPECT_EQ(a.at("rates").at("ao"), 2);
    const Json b = settingsOf(" --shading-rate 2 --local-rate=0.1");
    EXPECT_NEAR(b.at("local_rate").get<double>(), 0.1, 1e-6);
    const Json c = settingsOf(" --scale 0.5 --full-resize --shading-rate 2");
    EXPECT_EQ(c.at("render_scale"), 0.5);
    EXPECT_EQ(c.at("full_resize"), true);
    const Json d = settingsOf(" --scale 0.5x1 --temporal lodestar --frames 2 --validate");
    EXPECT_EQ(d.at("render_scale_axes"), Json::array({0.5, 1}));
    EXPECT_NEAR(d.at("render_scale").get<double>(), std::sqrt(0.5), 1e-6);
    EXPECT_EQ(settingsOf(" --scale 1x1.5").at("max_scale"), 1.5);
}

TEST(LeverOptions, aScaleThatIsNoneIsRefusedInOneLine) {
    const TempFolder folder;
    const std::string command =
        "render builtin:spheres --size 48x32 --out " + (folder / "p.png").string() + " --scale ";
    for (const std::string wrong :
         {"0.4", "2.5", "0.4x1", "1x3", "1x", "x1", "1x1x1", "1,1", "nan", "1xinf"}) {
        const auto [status, line] = run(folder, command + wrong);
        EXPECT_EQ(status, 2) << wrong;
        EXPECT_NE(line.find("'" + wrong + "' is no scale"), std::string::npos) << line;
        EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    }
}

TEST(Controls, areShownFrameByFrameAndWrongOnesAreRefused) {
    const TempFolder folder;
    const std::string report = (folder / "r.json").string(), table = (folder / "t.csv").string();
    const std::string command = "render builtin:columns --size 48x32 --frames 6 --out " +
                                (folder / "p.png").string() + " --json " + report;
    const std::string held = " --budget 50% --controller proportional";
    const auto [status, error] =
        run(folder, command + held + " --controls scale,layer,shadow --trace " + table);
    ASSERT_EQ(status, 0) << error;
    const Json json = Json::parse(contents(report));
    // Nothing is blended and nothing moves: what cannot help is left alone.
    EXPECT_EQ(json.at("budget").at("controls"), Json::array({"scale"}));
    EXPECT_NE(contents(folder / "stdout").find("nothing in the scene is blended"),
              std::string::npos);
    ASSERT_EQ(json.at("frames").size(), 6u);
    for (const Json& frame : json.at("frames")) {
        EXPECT_EQ(frame.at("layer_scale"), 1);
        EXPECT_EQ(frame.at("shadow_scale"), 1);
        EXPECT_EQ(frame.at("s"), frame.at("s_x"));
    }
    const std::string columns = "frame,r,frame_ms,target_ms,s,s_x,s_y,layer_scale,shadow_scale,";
    EXPECT_EQ(contents(table).substr(0, columns.size()), columns);
    for (const auto& [wrong, exitCode] : {std::pair{held + " --controls bloom", 2},
                                          {held + " --controls scale,", 2},
                                          {held + " --controls layer", 1},
                                          {std::string(" --controls layer"), 1},
                                          {std::string(" --budget 50% --controls layer"), 1},
                                          {std::string(" --trace t.csv"), 1}}) {
        const auto [refused, line] = run(folder, command + wrong);
        EXPECT_EQ(refused, exitCode) << wrong;
        EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << wrong << line;
    }
}

TEST(EffectOptions, reachTheFrameAndWrongOnesAreRefusedInALine) {
    const TempFolder folder;
    const std::string report = (folder / "r.json").string();
    const std::string command = "render builtin:spheres --size 48x32 --out " +
                                (folder / "p.png").string() + " --json " + report;
    const auto [status, error] =
        run(folder, command +
                        " --dof-radius 0.02 --dof 4,0.5,3 --ssao --ssao-radius 0.4 "
                        "--motion-blur 0.5 --post-rate ssao=16,dof=1 --post-combine linear "
                        "--frames 2 --path orbit:4 --validate");
    EXPECT_EQ(status, 0) << error;
    const Json settings = Json::parse(contents(report)).at("settings");
    const Json& post = settings.at("post");
    EXPECT_EQ(post.at("ssao"), true);
    EXPECT_NEAR(post.at("ssao_radius").get<double>(), 0.4, 1e-6);
    EXPECT_EQ(post.at("dof_focus"), 4);
    EXPECT_EQ(post.at("dof_full"), 3);
    EXPECT_NEAR(post.at("dof_radius").get<double>(), 0.02, 1e-6);
    EXPECT_EQ(post.at("motion_blur"), 0.5);
    EXPECT_EQ(post.at("combine"), "linear");
    EXPECT_EQ(settings.at("post_rates").at("ssao"), 16);
    EXPECT_EQ(settings.at("post_rates").at("dof"), 1);
    EXPECT_EQ(settings.at("post_rates").at("motion-blur"), 4);
    for (const auto& [wrong, exitCode] : {std::pair{" --post-rate 5", 2},
                                          {" --post-rate bloom=4", 2},
                                          {" --dof 4,3", 2},
                                          {" --dof 4,3,2", 2},
                                          {" --dof 0", 2},
                                          {" --ssao-radius 1", 2},
                                          {" --motion-blur 2", 2},
                                          {" --post-combine cubic", 2},
                                          {" --ssao --full-resize --shading-rate 2", 1},
                                          {" --motion-blur 0.5 --capture-rate 4", 1}}) {
        const auto [refused, line] = run(folder, command + wrong);
        EXPECT_EQ(refused, exitCode) << wrong;
        EXPECT_FALSE(line.empty()) << wrong;
    }
}

TEST(SettingsFile, thatIsWrongIsRefusedAndSaysWhere) {
    const TempFolder folder;
    const auto file = folder / "s.json";
    const auto read = [&](const std::string& text) {
        std::ofstream(file, std::ios::binary) << text;
        return readSettings(file);
    };
    const std::string good =
        R"({"rates":{"shadow":4,"ao":2.5,"noise":1},"repair":0.02,"local_rate":0})";
    const auto levers = read(good);
    ASSERT_TRUE(levers) << levers.error().message;
    EXPECT_NEAR(levers->rate(budget::Term::shadow), 4, 1e-5);
    EXPECT_NEAR(levers->rate(budget::Term::ao), 2.5, 1e-5);
    EXPECT_NEAR(levers->rate(budget::Term::noise), 1, 1e-5);
    for (std::size_t length = 0; length < good.size(); ++length)
        EXPECT_FALSE(read(good.substr(0, length))) << length;
    for (const std::string& wrong :
         {std::string("[]"), std::string(R"({"rates":[4,2,1],"repair":0,"local_rate":0})"),
          std::string(R"({"rates":{"shadow":0.5,"ao":2,"noise":1},"repair":0,"local_rate":0})"),
          std::string(R"({"rates":{"shadow":1e9,"ao":2,"noise":1},"repair":0,"local_rate":0})"),
          std::string(R"({"rates":{"shadow":"4","ao":2,"noise":1},"repair":0,"local_rate":0})"),
          std::string(R"({"rates":{"shadow":4,"ao":2,"noise":1},"repair":2,"local_rate":0})")}) {
        const auto refused = read(wrong);
        ASSERT_FALSE(refused) << wrong;
        EXPECT_NE(refused.error().message.find(file.string()), std::string::npos);
    }
}

TEST(PaperScenes, loadGivesTheShareThatWasAskedFor) {
    // A term of cost a·octaves·(1 + 3·warps) beside a fixed 100.
    const auto costOf = [](Load load) { return 2.0 * load.amount * (1 + 3.0 * load.warps); };
    const auto share = [&](Load load) { return costOf(load) / (100 + costOf(load)); };
    const Load paper = paperLoad(budget::Term::noise);
    for (const double wanted : {0.2, 0.5, 0.65, 0.8})
        EXPECT_NEAR(share(loadFor(budget::Term::noise, wanted, paper, share(paper))), wanted, 0.06);
    // Taps cost what their window touches.
    const auto taps = [](Load load) { return 1.5 * (load.amount + 1) * (load.amount + 1); };
    const auto tapShare = [&](Load load) { return taps(load) / (300 + taps(load)); };
    const Load nine = paperLoad(budget::Term::shadow);
    EXPECT_NEAR(tapShare(loadFor(budget::Term::shadow, 0.93, nine, tapShare(nine))), 0.93, 0.01);
    EXPECT_EQ(loadFor(budget::Term::shadow, 0.9999, nine, tapShare(nine)).amount, 128u);
}

TEST(Motion, ofAPlaneFollowsTheCameraAndHiddenPixelsHaveNone) {
    const int width = 41, height = 31;
    const scene::Camera before{.eye = {0, 0, 10}, .at = {0, 0, 0}, .verticalFov = 0.6f};
    scene::Camera now = before;
    now.eye.x = now.at.x = 0.5f;  // the plane z = 0 moves to the left by the same everywhere
    std::vector<float> depth(std::size_t(width * height), 10.0f);
    depth[5] = 0;
    std::vector<float> was = depth;
    const auto motion = motionBetween({before, was}, {now, depth}, width, height);
    const float pixels = 0.5f / (10 * std::tan(0.3f)) * float(height) / 2;
    const std::size_t middle = std::size_t(15 * width + 20);
    EXPECT_NEAR(motion.offsets[2 * middle], pixels, 1e-3);
    EXPECT_NEAR(motion.offsets[2 * middle + 1], 0, 1e-3);
    EXPECT_TRUE(std::isnan(motion.offsets[2 * 5])) << "background";
    // Something nearer stood where the middle was.
    was[std::size_t(15 * width) + std::size_t(std::lround(20 + pixels))] = 4;
    EXPECT_TRUE(
        std::isnan(motionBetween({before, was}, {now, depth}, width, height).offsets[2 * middle]));
}

BenchOptions quickOptions(const TempFolder& folder) {
    BenchOptions options{.out = folder / "out", .device = {.validation = true}};
    makeQuick(options);
    options.view.size = {96, 64};
    options.rounds = 1;
    return options;
}

TEST(ResizingBenches, sigmaComparesFourWidthsAtTheRatesOfTheFigure) {
    const TempFolder folder;
    const auto json = runBench("sigma", quickOptions(folder));
    ASSERT_TRUE(json) << json.error().message;
    EXPECT_EQ(json->at("rows").size(), 20u);
    // Both widths infinite is bilinear: small ones must do better where surfaces meet.
    // (At this size most of a fine-grained picture's error lies elsewhere.)
    for (const Json& bar : json->at("bars")) {
        const std::string what = bar.at("what");
        if (what.find("full resizing") == std::string::npos) continue;
        EXPECT_TRUE(bar.at("holds").get<bool>()) << bar;
    }
    EXPECT_TRUE(readImage(folder / "out/sigma.full-resizing.r7.3.crops.png"));
}

TEST(ResizingBenches, framerateControlDisturbsTheRunFourWays) {
    const TempFolder folder;
    BenchOptions options = quickOptions(folder);
    options.frames = 24;
    const auto json = runBench("framerate-control", options);
    ASSERT_TRUE(json) << json.error().message;
    EXPECT_EQ(json->at("rows").size(), 10u);
    const std::string trace = folder.read("out/framerate-control.trace.csv");
    EXPECT_EQ(std::count(trace.begin(), trace.end(), '\n'), 25);
    for (const char* what : {"view", "coverage", "load", "all"})
        EXPECT_NE(trace.find(what), std::string::npos);
    EXPECT_NE(trace.find(",20,"), std::string::npos) << "the load goes up by five taps";
}

TEST(ResizingBenches, flickerIsMeasuredForEveryWay) {
    const TempFolder folder;
    BenchOptions options = quickOptions(folder);
    options.frames = 4;
    const auto json = runBench("shading-flicker", options);
    ASSERT_TRUE(json) << json.error().message;
    ASSERT_EQ(json->at("rows").size(), 5u);
    for (const Json& row : json->at("rows")) {
        EXPECT_GT(row.at("full_flicker").get<double>(), 0);
        EXPECT_GT(row.at("added_flicker").get<double>(), 0) << row;
    }
}

TEST(ResizingBenches, automaticSplitsAreComparedWithThoseMadeByHand) {
    const TempFolder folder;
    BenchOptions options = quickOptions(folder);
    options.view.size = {48, 32};
    const auto json = runBench("split", options);
    ASSERT_TRUE(json) << json.error().message;
    std::size_t hands = 0, automatic = 0;
    for (const Json& row : json->at("rows")) {
        hands += row.at("method") == "by hand";
        automatic += row.at("method") == "automatic";
    }
    EXPECT_EQ(hands, 134u);
    EXPECT_EQ(automatic, 3u);
}

TEST(ResizingBenches, framebufferLodHasRowsOfEveryWayAndRate) {
    const TempFolder folder;
    const auto json = runBench("framebuffer-lod", quickOptions(folder));
    ASSERT_TRUE(json) << json.error().message;
    EXPECT_EQ(json->at("rows").size(), 1u + 8 * 8);
    for (const Json& row : json->at("rows")) {
        const std::string method = row.at("method");
        const bool local = method.ends_with("local r") || method.ends_with("both");
        if (!local) {
            EXPECT_EQ(row.value("refined_texels", 0), 0) << row;
        }
    }
}

}  // namespace
}  // namespace lodestar::app

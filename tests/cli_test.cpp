// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "app/cli.hpp"
#include "app/console.hpp"
#include "app/inspect.hpp"
#include "app/report_json.hpp"

using namespace lodestar::app;
namespace fs = std::filesystem;

namespace {

/// An empty folder of the running test, gone with it.
class Folder {
public:
    explicit Folder(const char* purpose = "") {
        const auto* test = testing::UnitTest::GetInstance()->current_test_info();
        path = fs::temp_directory_path() / (std::string("lodestar_cli_") + test->name() + purpose);
        fs::remove_all(path);
        fs::create_directories(path);
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    fs::path operator/(const char* name) const { return path / name; }

private:
    fs::path path;
};

std::string contents(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

struct Ended {
    int status = 0;
    std::string out, err;
};

/// Runs the program itself, its output piped.
Ended lodestarRun(const std::string& arguments) {
    const Folder folder("_output");
    const std::string command = "\"" LODESTAR_PROGRAM "\" " + arguments + " > \"" +
                                (folder / "out").string() + "\" 2> \"" + (folder / "err").string() +
                                "\"";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(folder / "out"),
            contents(folder / "err")};
}

void expectOneErrorLine(const Ended& run) {
    EXPECT_EQ(run.err.rfind("lodestar: error: ", 0), 0u) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
}

}  // namespace

TEST(Options, sizesAreRead) {
    EXPECT_EQ(parseSize("1280x720")->width, 1280);
    EXPECT_EQ(parseSize("1280x720")->height, 720);
    EXPECT_EQ(parseSize("16384x1")->width, 16384);
}

TEST(Options, whatIsNoSizeIsRefused) {
    for (const char* text : {"", "x", "1280", "1280x", "x720", "0x720", "1280x-1", "1280x720x3",
                             "1280 x 720", "16385x1", "99999999999x1", "1e3x1"})
        EXPECT_FALSE(parseSize(text)) << text;
}

TEST(Options, pointsAreRead) {
    EXPECT_EQ(*parseVector("1,-2.5,3e2"), glm::vec3(1, -2.5f, 300));
    for (const char* text : {"", "1,2", "1,2,3,4", "1,,3", "1, 2,3", "a,b,c", "1,2,nan", "1,2,inf"})
        EXPECT_FALSE(parseVector(text)) << text;
}

TEST(Options, aRefusedValueIsBadUsageNamingTheOption) {
    CLI::App app;
    ViewOptions view;
    addViewOptions(app, view);
    app.parse("--size 640x360 --eye 1,2,3 --at 0,0,0 --fov 45 --orbit -30");
    EXPECT_EQ(view.size.width, 640);
    EXPECT_EQ(view.eye, glm::vec3(1, 2, 3));
    EXPECT_EQ(view.fovDegrees, 45);
    EXPECT_EQ(view.orbitDegrees, -30);
    try {
        app.parse("--size 640");
        FAIL() << "accepted";
    } catch (const CLI::ValidationError& error) {
        EXPECT_NE(std::string(error.what()).find("--size"), std::string::npos) << error.what();
    }
    EXPECT_THROW(app.parse("--eye 1,2,3"), CLI::ParseError) << "needs --at";
    EXPECT_THROW(app.parse("--camera 0 --eye 1,2,3 --at 0,0,0"), CLI::ParseError);
    EXPECT_THROW(app.parse("--fov 180"), CLI::ParseError);
}

TEST(Console, numbersAreReadable) {
    EXPECT_EQ(formatCount(0), "0");
    EXPECT_EQ(formatCount(999), "999");
    EXPECT_EQ(formatCount(1000), "1,000");
    EXPECT_EQ(formatCount(1234567), "1,234,567");
    EXPECT_EQ(formatBytes(1023), "1023 B");
    EXPECT_EQ(formatBytes(1536), "1.5 KiB");
    EXPECT_EQ(formatBytes(1024 * 1024 - 1), "1.0 MiB");
    EXPECT_EQ(formatBytes(5ull << 30), "5.0 GiB");
    EXPECT_EQ(formatMs(0.416), "0.42 ms");
    EXPECT_EQ(formatMs(12.34), "12.3 ms");
    EXPECT_EQ(formatMs(99.96), "100 ms");
}

TEST(Console, tableColumnsAlign) {
    Table table({{"pass", Table::Align::left}, {"time", Table::Align::right}});
    table.row({"shade coarse", "9.1 ms"});
    table.row({"größe", "180 ms"});
    EXPECT_EQ(table.text(),
              "  pass            time\n"
              "  shade coarse  9.1 ms\n"
              "  größe         180 ms\n");
    EXPECT_THROW(table.row({"one cell"}), std::invalid_argument);
}

TEST(Console, namesFromFilesCannotSteerTheTerminal) {
    EXPECT_EQ(printable("a\x1b[2Jb\nc\x7f"), "a?[2Jb c?");
    EXPECT_EQ(printable("caf\xc3\xa9 \xc2\x9b"), "caf\xc3\xa9 ?") << "UTF-8 stays, C1 goes";
}

TEST(Progress, saysNothingWithinASecondOrWithoutATerminal) {
    std::ostringstream quick, piped;
    double now = 0;
    const auto clock = [&] { return now; };
    {
        Progress fast("render", 10, {&quick, true, clock}),
            silent("render", 10, {&piped, false, clock});
        now = 0.9;
        fast.update(5);
        now = 30;
        silent.update(9);
    }
    EXPECT_EQ(quick.str(), "");
    EXPECT_EQ(piped.str(), "");
}

TEST(Progress, showsAfterASecondAndLeavesNothing) {
    std::ostringstream out;
    double now = 0;
    {
        Progress progress("render", 10, {&out, true, [&] { return now; }});
        now = 2;
        progress.update(5);
        EXPECT_NE(out.str().find("render [###############---------------] 5/10  0:02 left"),
                  std::string::npos)
            << out.str();
        const std::size_t length = out.str().size();
        now = 2.05;
        progress.update(6);
        EXPECT_EQ(out.str().size(), length) << "redrawn no more than ten times a second";
    }
    EXPECT_EQ(out.str().substr(out.str().size() - 4), "\r\x1b[K");
}

TEST(Report, hasTheFieldsEveryCommandPromises) {
    Report report;
    report.scene = "a.glb";
    report.passes = {{"shade", 2, 1, 4}};
    report.memory = {{"depth", 100, true}, {"vertices", 50, false}};
    report.quality = QualityFigures{40, 0.99, 0.01};
    const Json json = toJson(report);
    EXPECT_EQ(json["lodestar"], LODESTAR_VERSION);
    for (const char* key : {"device", "driver", "scene", "settings", "passes", "frame_ms", "counts",
                            "memory", "peak_bytes", "quality"})
        EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json["device"].is_null());
    EXPECT_EQ(json["passes"][0]["ms_median"], 2);
    EXPECT_EQ(json["passes"][0]["ms_min"], 1);
    EXPECT_EQ(json["passes"][0]["ms_max"], 4);
    EXPECT_EQ(json["memory"][0]["transient"], true);
    EXPECT_EQ(json["peak_bytes"], 150);
    EXPECT_EQ(json["quality"]["psnr_db"], 40);
}

TEST(Report, identicalPicturesAreNoInvalidJson) {
    Report report;
    report.quality = QualityFigures{std::numeric_limits<double>::infinity(), 1, 0};
    const Json read = Json::parse(toJson(report).dump());
    EXPECT_TRUE(read["quality"]["psnr_db"].is_null());
    EXPECT_EQ(read["quality"]["identical"], true);
}

TEST(Report, passesAreSummarisedOverTheFramesThatRanThem) {
    using lodestar::budget::FrameCosts;
    const std::vector<FrameCosts> frames = {{10, {{"cull", 1}, {"shade", 5}, {"shade", 1}}},
                                            {10, {{"cull", 3}, {"shade", 7}}},
                                            {10, {{"cull", 2}, {"repair", 9}, {"shade", 8}}}};
    const auto passes = summarisePasses(frames);
    ASSERT_EQ(passes.size(), 3u);
    EXPECT_EQ(passes[0].name, "cull");
    EXPECT_EQ(passes[0].median, 2);
    EXPECT_EQ(passes[1].name, "shade");
    EXPECT_EQ(passes[1].least, 6) << "twice in a frame counts as the sum";
    EXPECT_EQ(passes[1].most, 8);
    EXPECT_EQ(passes[2].median, 9);
}

TEST(Report, jsonIsWrittenWholeOverAnOldFile) {
    const Folder folder;
    const fs::path file = folder / "report.json";
    ASSERT_TRUE(writeJson(file, {{"name", "bytes \xff that are no UTF-8"}}));
    ASSERT_TRUE(writeJson(file, {{"a", 1}})) << "an old file is replaced";
    EXPECT_EQ(Json::parse(contents(file))["a"], 1);
    EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1) << "no leftovers";
}

TEST(Report, whatCannotBeWrittenIsNamed) {
    const Folder folder;
    std::ofstream(folder / "file") << "in the way";
    for (const fs::path& file :
         {folder / "file/report.json", folder / "absent/report.json", folder / "."}) {
        const auto written = writeJson(file, Json::object());
        ASSERT_FALSE(written);
        EXPECT_NE(written.error().message.find(file.string()), std::string::npos);
    }
}

TEST(Inspection, countsWhatInstancesShare) {
    lodestar::scene::Scene scene;
    lodestar::scene::Mesh mesh;
    for (glm::vec3 p : {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}) {
        mesh.vertices.push_back({.position = p});
        mesh.bounds.add(p);
    }
    mesh.indices = {0, 1, 2};
    scene.meshes = {mesh};
    scene.materials.resize(2);
    scene.materials[1].alphaMode = lodestar::scene::AlphaMode::mask;
    scene.materials[1].doubleSided = true;
    scene.nodes.resize(2);
    scene.nodes[1].translation = {10, 0, 0};
    scene.instances = {{.mesh = 0, .node = 0}, {.mesh = 0, .node = 1}};

    const Inspection found = inspectScene(scene, 0);
    EXPECT_EQ(found.triangles.stored, 1u);
    EXPECT_EQ(found.triangles.drawn, 2u);
    EXPECT_EQ(found.vertices, 3u);
    EXPECT_EQ(found.meshletsStored, 1u);
    EXPECT_EQ(found.meshletsDrawn, 2u);
    EXPECT_EQ(found.materials.opaque, 1u);
    EXPECT_EQ(found.materials.mask, 1u);
    EXPECT_EQ(found.materials.doubleSided, 1u);
    EXPECT_EQ(found.bounds.upper, glm::vec3(11, 1, 0));
    ASSERT_FALSE(found.memory.empty());
    EXPECT_EQ(found.memory[0].bytes, 3 * sizeof(lodestar::scene::Vertex));
}

TEST(Program, versionAndHelpSucceed) {
    EXPECT_EQ(lodestarRun("--version").out, "lodestar " LODESTAR_VERSION "\n");
    for (const char* arguments : {"--help", "inspect --help"}) {
        const Ended help = lodestarRun(arguments);
        EXPECT_EQ(help.status, kExitOk);
        EXPECT_EQ(help.err, "");
        EXPECT_NE(help.out.find("Examples:"), std::string::npos) << arguments;
    }
    EXPECT_NE(lodestarRun("--help").out.find("inspect"), std::string::npos);
}

TEST(Program, badUsageIsOneLineAndStatusTwo) {
    for (const char* arguments :
         {"", "transmogrify", "inspect", "inspect a.glb --frobnicate", "inspect a.glb --seconds -1",
          "inspect a.glb --seconds soon", "inspect a.glb b.glb", "--frobnicate"}) {
        SCOPED_TRACE(arguments);
        const Ended run = lodestarRun(arguments);
        EXPECT_EQ(run.status, kExitUsage);
        expectOneErrorLine(run);
        EXPECT_NE(run.err.find("--help"), std::string::npos) << "says where to look";
    }
    EXPECT_NE(lodestarRun("transmogrify").err.find("inspect"), std::string::npos)
        << "names the commands there are";
}

TEST(Program, aFileThatIsNotThereIsOneLineAndStatusOne) {
    const Ended run = lodestarRun("inspect no_such_file.glb");
    EXPECT_EQ(run.status, kExitFailure);
    expectOneErrorLine(run);
    EXPECT_NE(run.err.find("no_such_file.glb"), std::string::npos) << run.err;
}

TEST(Program, inspectListsTheProceduralScenes) {
    const Ended run = lodestarRun("inspect builtin:");
    EXPECT_EQ(run.status, kExitOk);
    for (const char* name : {"builtin:columns", "builtin:spheres", "builtin:grid:N"})
        EXPECT_NE(run.out.find(name), std::string::npos) << name;
}

TEST(Program, inspectSaysWhatIsInAScene) {
    const Folder folder;
    const fs::path json = folder / "scene.json";
    const Ended run = lodestarRun("inspect builtin:grid:1000 --json \"" + json.string() + "\"");
    ASSERT_EQ(run.status, kExitOk) << run.err;
    EXPECT_EQ(run.err, "");
    EXPECT_NE(run.out.find("triangles"), std::string::npos);
    const Json read = Json::parse(contents(json));
    EXPECT_EQ(read["scene"], "builtin:grid:1000");
    EXPECT_GE(read["counts"]["triangles_drawn"].get<int>(), 900);
    EXPECT_GT(read["counts"]["meshlets_stored"].get<int>(), 1000 / 124 - 1);
    EXPECT_GT(read["bounds"]["radius"].get<double>(), 0);
}

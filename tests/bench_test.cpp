// SPDX-License-Identifier: Apache-2.0
#include "app/bench/bench.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include <lodestar/shared/octahedral.h>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/metrics.hpp>

#include "app/bench/depth_edges.hpp"
#include "app/bench/gbuffer.hpp"
#include "app/bench/published.hpp"
#include "app/bench/results.hpp"
#include "app/image_io.hpp"
#include "app/judge.hpp"
#include "gpu_device.hpp"
#include "temp_folder.hpp"

namespace lodestar::app {
namespace {

BenchOptions quickOptions(const TempFolder& folder) {
    BenchOptions options{.out = folder / "out", .device = {.validation = true}};
    makeQuick(options);
    return options;
}

const Bench& benchCalled(const std::string& name) {
    return *std::find_if(benches().begin(), benches().end(),
                         [&](const Bench& b) { return b.name == name; });
}

const Json& barStarting(const Json& bars, const std::string& words) {
    for (const Json& bar : bars)
        if (bar.at("what").get<std::string>().starts_with(words)) return bar;
    throw std::runtime_error("no bar '" + words + "'");
}

const Json& rowOf(const Json& rows, const std::string& method, std::optional<double> r = {}) {
    for (const Json& row : rows)
        if (row.at("method") == method && (!r || row.value("r", 0.0) == *r)) return row;
    throw std::runtime_error("no row '" + method + "'");
}

std::vector<std::vector<std::string>> cellsOf(const std::string& csv) {
    std::vector<std::vector<std::string>> lines;
    std::istringstream text(csv);
    for (std::string line; std::getline(text, line);) {
        std::istringstream cells(line);
        lines.emplace_back();
        for (std::string cell; std::getline(cells, cell, ',');) lines.back().push_back(cell);
    }
    return lines;
}

TEST(DepthEdges, flatDepthHasNone) {
    const std::vector<float> depth(20, 3.0f);
    EXPECT_EQ(depthEdgeMask(depth, 5, 4), std::vector<std::uint8_t>(20, 0));
}

TEST(DepthEdges, reachTwoPixelsFromAStep) {
    std::vector<float> depth(10, 1.0f);  // one row: the step lies between pixels 4 and 5
    std::fill(depth.begin() + 5, depth.end(), 1.1f);
    EXPECT_EQ(depthEdgeMask(depth, 10, 1),
              (std::vector<std::uint8_t>{0, 0, 1, 1, 1, 1, 1, 1, 0, 0}));
}

TEST(DepthEdges, ignoreAStepWithinFivePercent) {
    std::vector<float> depth(10, 100.0f);
    std::fill(depth.begin() + 5, depth.end(), 104.0f);
    EXPECT_EQ(depthEdgeMask(depth, 10, 1), std::vector<std::uint8_t>(10, 0));
}

TEST(DepthEdges, surroundSurfacesAgainstTheBackground) {
    std::vector<float> depth(81, 0.0f);
    depth[40] = 7;
    const auto mask = depthEdgeMask(depth, 9, 9);
    EXPECT_EQ(mask[40], 1);
    EXPECT_EQ(mask[40 + 3], 1);  // two from the neighbour that is background
    EXPECT_EQ(mask[40 + 4], 0);
    EXPECT_EQ(mask[40 - 27], 1);
    EXPECT_EQ(mask[40 - 36], 0);
}

TEST(WorstRegion, holdsTheLargestErrorInsideTheMask) {
    const quality::RgbImage reference(20, 10);
    quality::RgbImage test = reference;
    *test.at(15, 7) = 90;
    *test.at(3, 3) = 200;  // larger, but not at an edge
    std::vector<std::uint8_t> mask(200, 0);
    mask[7 * 20 + 15] = 1;
    const Region region = worstRegion(reference, test, mask, 4, 4);
    EXPECT_LE(region.x, 15);
    EXPECT_GT(region.x + region.width, 15);
    EXPECT_LE(region.y, 7);
    EXPECT_GT(region.y + region.height, 7);
}

TEST(Crops, areZoomedSideBySide) {
    quality::RgbImage a(6, 6), b(6, 6);
    *a.at(2, 3) = 11;
    *b.at(3, 3) = 22;
    const auto crops = cropsSideBySide({&a, &b}, {2, 3, 2, 1}, 4);
    ASSERT_EQ(crops.width, 2 * 8 + 4);
    ASSERT_EQ(crops.height, 4);
    EXPECT_EQ(*crops.at(3, 3), 11);
    EXPECT_EQ(*crops.at(4, 3), 0);
    EXPECT_EQ(*crops.at(12 + 3, 0), 0);
    EXPECT_EQ(*crops.at(12 + 4, 0), 22);
}

TEST(BenchCsv, hasAColumnForEveryKeyAndQuotes) {
    const Json rows = Json::array({{{"a", 1}, {"b", "x,\"y\""}}, {{"a", nullptr}, {"c", 2.5}}});
    EXPECT_EQ(csvOf(rows), "a,b,c\n1,\"x,\"\"y\"\"\",\n,,2.5\n");
}

TEST(Published, hasTheFiguresAsPrinted) {
    const Json& figure = published("yang2008_fig2");
    ASSERT_EQ(figure.at("rows").size(), 3u);
    EXPECT_EQ(figure.at("rows")[1].at("scene"), "chess");
    EXPECT_EQ(figure.at("rows")[1].at("fine_grained").at("fps"), 21);
    EXPECT_THROW(published("no such table"), std::invalid_argument);
}

/// What is behind the camera is neither drawn nor counted.
TEST(Counts, sayWhatTheLastFrameDrew) {
    auto session = openSession("builtin:columns", {.validation = true});
    ASSERT_TRUE(session);
    frame::Frame frame(*session->device, *session->gpuScene, {.size = {64, 36}});
    scene::Camera camera = *resolveCamera(*session, {.size = {64, 36}});
    frame.render(camera, {});
    const Json whole = countsOf(*session, frame);
    EXPECT_EQ(whole.at("instances_visible"), whole.at("instances_total"));  // framed as a whole
    EXPECT_LE(whole.at("triangles_visible"), whole.at("triangles_total"));

    camera.at = 2.0f * camera.eye - camera.at;
    frame.render(camera, {});
    const Json none = countsOf(*session, frame);
    for (const char* things : {"instances", "clusters", "triangles"})
        EXPECT_EQ(none.at(std::string(things) + "_visible"), 0) << things;
    EXPECT_EQ(session->device->validationMessages(), std::vector<std::string>());
}

TEST(Bench, namesItsScenesFolderWhenItIsMissing) {
    TempFolder folder;
    BenchOptions options{.out = folder / "out", .scenes = folder / "nowhere"};
    const auto result = runBench("budget-hold", options);
    ASSERT_FALSE(result);
    EXPECT_NE(result.error().message.find("nowhere"), std::string::npos);
    EXPECT_NE(result.error().message.find("--scenes"), std::string::npos);
}

TEST(Bench, refusesANameItDoesNotKnow) {
    TempFolder folder;
    EXPECT_THROW(static_cast<void>(runBench("no-such", quickOptions(folder))),
                 std::invalid_argument);
}

TEST(Results, holdTheNewestRunOfEachBenchAndLeaveOtherFilesAlone) {
    TempFolder folder;
    const auto write = [&](const char* name, double ms) {
        const Bench bench{.name = name,
                          .what = "a bench",
                          .run = nullptr,
                          .bars = nullptr,
                          .tables = {{"speed", {"scene", "frame_ms"}}},
                          .onCpu = {},
                          .onGpu = {}};
        BenchResult result;
        result.report.settings = {{"width", 8}, {"height", 4}, {"rounds", 1}};
        result.rows = {{{"measures", "speed"}, {"scene", "a"}, {"frame_ms", ms}}};
        result.bars = {{"a bar", ms, "ms", "<= 1", ms <= 1}};
        return writeResult(bench, result, folder / ".");
    };
    ASSERT_TRUE(write("ssao", 4));
    ASSERT_TRUE(write("dof", 2));
    ASSERT_TRUE(write("ssao", 3));
    const Json all = Json::parse(folder.read("results.json")).at("benches");
    EXPECT_EQ(all.size(), 2u);
    EXPECT_EQ(all.at("ssao").at("rows").at(0).at("frame_ms"), 3);
    EXPECT_EQ(all.at("dof").at("bars").at(0).at("holds"), false);
    const std::string page = folder.read("results.md");
    EXPECT_LT(page.find("## ssao"), page.find("## dof"));  // as `bench list` has them
    EXPECT_NE(page.find("MISSED"), std::string::npos);

    folder.write("results.json", "[1, 2]");
    const auto refused = write("dof", 2);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("results.json"), std::string::npos);
    EXPECT_EQ(folder.read("results.json"), "[1, 2]");
}

TEST(AttributeComparison, gbufferHoldsWhatIsRebuilt) {
    auto session = openSession("builtin:columns", {.validation = true});
    ASSERT_TRUE(session);
    const vk::Extent2D extent{160, 90};
    const auto camera = resolveCamera(*session, {.size = {160, 90}});
    AttributeComparison comparison(*session->device, *session->gpuScene, extent);
    comparison.fromVisibility(*camera);
    comparison.fromGBuffer(*camera);

    const auto& device = *session->device;
    const auto depthA = gpu::as<float>(gpu::readImage(device, comparison.rebuilt().depth));
    const auto depthB = gpu::as<float>(gpu::readImage(device, comparison.drawn().depth));
    const auto wordsA = gpu::as<glm::uvec4>(gpu::readImage(device, comparison.rebuilt().material));
    const auto wordsB = gpu::as<glm::uvec4>(gpu::readImage(device, comparison.drawn().material));
    quality::RgbImage albedoA(160, 90), albedoB(160, 90);
    std::size_t surfaces = 0, depthsApart = 0, normalsApart = 0;
    for (std::size_t i = 0; i < depthA.size(); ++i) {
        ASSERT_EQ(depthA[i] == 0, depthB[i] == 0) << "pixel " << i;
        if (depthA[i] == 0) continue;
        ++surfaces;
        EXPECT_NEAR(depthA[i], depthB[i], 5e-3 * depthA[i]) << "pixel " << i;
        if (std::abs(depthA[i] - depthB[i]) > 1e-3f * depthA[i]) ++depthsApart;
        for (int c = 0; c < 3; ++c) {
            albedoA.rgb[3 * i + std::size_t(c)] = std::uint8_t(wordsA[i].x >> 8 * c);
            albedoB.rgb[3 * i + std::size_t(c)] = std::uint8_t(wordsB[i].x >> 8 * c);
        }
        const auto normalA = shared::unpackNormal(wordsA[i].w);
        const auto normalB = shared::unpackNormal(wordsB[i].w);
        if (glm::dot(normalA, normalB) < 0.999f) ++normalsApart;
    }
    EXPECT_GT(surfaces, depthA.size() / 8);
    EXPECT_GT(std::set(albedoA.rgb.begin(), albedoA.rgb.end()).size(), 16u);  // there is a pattern
    EXPECT_GE(quality::psnr(albedoA, albedoB), 45);
    // Hardware draws triangles with their corners moved to a fraction of a pixel.
    const std::size_t moved = onReferenceDriver() ? 0 : surfaces / 200;
    EXPECT_LE(depthsApart, moved);
    EXPECT_LE(normalsApart, moved);
    EXPECT_EQ(device.validationMessages(), std::vector<std::string>());
}

TEST(ShadingRateBench, barsFollowFromTheRows) {
    TempFolder folder;
    const auto json = runBench("shading-rate", quickOptions(folder));
    ASSERT_TRUE(json) << json.error().message;
    const Json& rows = json->at("rows");
    ASSERT_EQ(rows.size(), 7u + 2u);
    const Json& full = rowOf(rows, "full");
    EXPECT_EQ(full.at("speedup"), 1.0);
    for (const double r : {2.0, 3.0, 4.0}) {
        const Json &bilinear = rowOf(rows, "bilinear", r), &bilateral = rowOf(rows, "bilateral", r);
        for (const char* key :
             {"frame_ms", "wall_ms", "capture_ms", "rebuild_ms", "terms_ms", "combine_ms",
              "psnr_db", "ssim", "flip", "speedup", "edge_psnr_db", "edge_pixels"}) {
            ASSERT_TRUE(bilateral.contains(key)) << key;
            EXPECT_GT(bilateral.at(key).get<double>(), 0) << key;
        }
        EXPECT_NEAR(bilinear.at("speedup").get<double>(),
                    full.at("frame_ms").get<double>() / bilinear.at("frame_ms").get<double>(),
                    1e-9);
        const std::string place = ": builtin:columns, r = " + std::string(1, char('0' + int(r)));
        EXPECT_NEAR(
            barStarting(json->at("bars"), "bilateral over bilinear at depth edges" + place)
                .at("value"),
            bilateral.at("edge_psnr_db").get<double>() - bilinear.at("edge_psnr_db").get<double>(),
            1e-9);
        EXPECT_NEAR(
            barStarting(json->at("bars"),
                        "what bilateral adds to bilinear, of the full-quality frame" + place)
                .at("value"),
            100 *
                (bilateral.at("combine_ms").get<double>() -
                 bilinear.at("combine_ms").get<double>()) /
                full.at("frame_ms").get<double>(),
            1e-9);
    }
    const Json &a = rowOf(rows, "visibility"), &b = rowOf(rows, "gbuffer");
    EXPECT_NEAR(barStarting(json->at("bars"), "(capture + rebuild)").at("value"),
                (a.at("capture_ms").get<double>() + a.at("rebuild_ms").get<double>()) /
                    (b.at("gbuffer_ms").get<double>() + b.at("read_ms").get<double>()),
                1e-9);
    EXPECT_EQ(json->at("bars").size(), 3u + 3u + 2u);
    EXPECT_FALSE(json->at("source").empty());
    const Json& counts = json->at("counts");
    for (const char* things : {"instances", "clusters", "triangles"}) {
        const std::string name = things;
        EXPECT_GT(counts.at(name + "_visible").get<int>(), 0) << name;
        EXPECT_LE(counts.at(name + "_visible"), counts.at(name + "_total")) << name;
    }
    std::uint64_t ofAllLods = 0;
    for (const Json& ofOne : counts.at("triangles_per_lod"))
        ofAllLods += ofOne.get<std::uint64_t>();
    EXPECT_EQ(ofAllLods, counts.at("triangles_visible"));
    EXPECT_FALSE(json->at("device").get<std::string>().empty());

    // The files hold what was measured.
    const auto cells = cellsOf(folder.read("out/shading-rate.csv"));
    ASSERT_EQ(cells.size(), rows.size() + 1);
    EXPECT_EQ(Json::parse(folder.read("out/shading-rate.json")), *json);
    const auto reference = readImage(folder / "out/shading-rate.columns.full.png");
    const auto test = readImage(folder / "out/shading-rate.columns.r4-bilateral.png");
    ASSERT_TRUE(reference && test);
    EXPECT_NEAR(quality::psnr(*reference, *test),
                rowOf(rows, "bilateral", 4).at("psnr_db").get<double>(), 1e-9);
}

TEST(ShadingRateBench, barsTurnWithTheirRows) {
    const auto rows = [](double edgeGain, double bilateralMs, double rebuildMs) {
        return Json::array({{{"measures", "shading"},
                             {"scene", "s"},
                             {"method", "full"},
                             {"r", 1.0},
                             {"frame_ms", 100}},
                            {{"measures", "shading"},
                             {"scene", "s"},
                             {"method", "bilinear"},
                             {"r", 2.0},
                             {"combine_ms", 5},
                             {"edge_psnr_db", 30},
                             {"edge_pixels", 9}},
                            {{"measures", "shading"},
                             {"scene", "s"},
                             {"method", "bilateral"},
                             {"r", 2.0},
                             {"combine_ms", bilateralMs},
                             {"edge_psnr_db", 30 + edgeGain},
                             {"edge_pixels", 9}},
                            {{"measures", "attributes"},
                             {"scene", "s"},
                             {"method", "visibility"},
                             {"capture_ms", 10},
                             {"rebuild_ms", rebuildMs},
                             {"total_ms", 10 + rebuildMs}},
                            {{"measures", "attributes"},
                             {"scene", "s"},
                             {"method", "gbuffer"},
                             {"gbuffer_ms", 19},
                             {"read_ms", 1},
                             {"total_ms", 20}}});
    };
    const auto holds = [&](const Json& measured) {
        std::string text;
        for (const Bar& bar : benchCalled("shading-rate").bars(measured))
            text += bar.holds ? '1' : '0';
        return text;
    };
    EXPECT_EQ(holds(rows(2.0, 20, 20)), "1111");  // each at its limit, the last two at 2.0 and 1.5
    EXPECT_EQ(holds(rows(1.9, 20, 20)), "0111");
    EXPECT_EQ(holds(rows(2.0, 20.1, 20)), "1011");
    EXPECT_EQ(holds(rows(2.0, 20, 20.1)), "1101");
    EXPECT_EQ(holds(rows(2.0, 20, 30.1)), "1100");
}

TEST(BudgetHoldBench, figuresFollowFromTheTrace) {
    TempFolder folder;
    const BenchOptions options = quickOptions(folder);
    const auto json = runBench("budget-hold", options);
    ASSERT_TRUE(json) << json.error().message;
    ASSERT_EQ(json->at("rows").size(), 1u);
    const Json& row = json->at("rows")[0];
    EXPECT_NEAR(row.at("target_ms").get<double>(), 0.5 * row.at("full_ms").get<double>(), 1e-9);
    EXPECT_GT(row.at("psnr_db").get<double>(), 15);

    const auto trace = cellsOf(folder.read("out/budget-hold.columns.trace.csv"));
    ASSERT_EQ(trace.size(), options.frames + 1);
    const std::vector<std::string> columns{
        "frame", "r",   "frame_ms",    "target_ms",    "s",
        "s_x",   "s_y", "layer_scale", "shadow_scale", "cull_ms"};
    ASSERT_GT(trace[0].size(), columns.size()) << "the passes follow";
    EXPECT_TRUE(std::equal(columns.begin(), columns.end(), trace[0].begin()));
    std::size_t within = 0;
    for (std::size_t i = 16; i < trace.size(); ++i) {
        const double ms = std::stod(trace[i][2]), target = std::stod(trace[i][3]);
        EXPECT_GE(std::stod(trace[i][1]), 1);
        within += std::abs(ms - target) <= 0.1 * target;
    }
    const double share = double(within) / double(trace.size() - 16);
    EXPECT_NEAR(row.at("within_10_share").get<double>(), share, 1e-9);
    const Json& bar = barStarting(json->at("bars"), "frames within 10 % of the budget");
    EXPECT_NEAR(bar.at("value").get<double>(), 100 * share, 1e-9);
    EXPECT_EQ(bar.at("holds").get<bool>(), share >= 0.9);
    const Json& turns = barStarting(json->at("bars"), "frames at which r turns around");
    EXPECT_EQ(turns.at("holds").get<bool>(), row.at("turn_share").get<double>() < 0.1);
}

}  // namespace
}  // namespace lodestar::app

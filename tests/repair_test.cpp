// SPDX-License-Identifier: Apache-2.0
// Repair and the per-term rates, on whole frames of a thin lattice before a wall.
#include <cmath>

#include "fence_frames.hpp"

namespace lodestar::frame {
namespace {

using budget::Term;

class RepairTest : public GpuTest {};

TEST_F(RepairTest, repairedPixelsHoldTheirFullRateTermsAndTheErrorFalls) {
    Rig rig(device());
    const auto full = rig.terms({});
    const auto coarse = rig.terms({.shadingRate = 6});
    EXPECT_EQ(rig.frame.repairedPixels(), 0u);
    const auto repaired = rig.terms({.shadingRate = 6, .repair = 1});
    const std::uint32_t count = rig.frame.repairedPixels();
    ASSERT_GT(count, 50u);
    EXPECT_LT(count, 160u * 96 / 4);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < full.size(); ++i) {
        if (repaired[i] == coarse[i]) continue;
        ++changed;
        ASSERT_LT(glm::length(glm::vec2(repaired[i]) - glm::vec2(full[i])), 2e-3f) << i;
    }
    EXPECT_LE(changed, count);
    EXPECT_GT(changed, count / 4) << "most of what is listed was wrong";
    EXPECT_LT(errorOf(full, repaired), 0.7 * errorOf(full, coarse));
}

TEST_F(RepairTest, capIsKeptTheWorstGoFirstAndTheChoiceIsReproducible) {
    Rig rig(device());
    rig.terms({.shadingRate = 6, .repair = 1});
    const std::uint32_t all = rig.frame.repairedPixels();
    const float half = 0.5f * float(all) / (160 * 96);
    const auto first = rig.terms({.shadingRate = 6, .repair = half});
    const std::uint32_t kept = rig.frame.repairedPixels();
    EXPECT_LE(kept, all / 2);
    EXPECT_GT(kept, 0u);
    EXPECT_EQ(rig.terms({.shadingRate = 6, .repair = half}), first);
    // Those that were kept were worse than those that were not: they gain more a pixel.
    const auto full = rig.terms({}), coarse = rig.terms({.shadingRate = 6}),
               whole = rig.terms({.shadingRate = 6, .repair = 1});
    const double gain = errorOf(full, coarse) - errorOf(full, first);
    const double most = errorOf(full, coarse) - errorOf(full, whole);
    EXPECT_GT(gain / kept, 0.8 * most / all);
}

/// The lattice, floor and wall twice, side by side: white on the left and black on the right.
Scene whiteAndBlack() {
    small_scenes::SceneBuilder builder("white and black");
    for (const float corner : {-4.0f, 0.0f}) {
        const float shade = corner < 0 ? 0.8f : 0.0f;
        const std::uint32_t material =
            builder.add(scene::Material{.baseColor = {shade, shade, shade, 1},
                                        .metallic = 0,
                                        .roughness = 1,
                                        .doubleSided = true});
        const auto add = [&](const char* name, glm::vec3 at, glm::vec3 a, glm::vec3 b) {
            builder.place(builder.add(
                name,
                small_scenes::parts::patch(small_scenes::parts::rectangle(at, a, b), 1, 1, {1, 1}),
                material));
        };
        add("floor", {corner, 0, -4}, {0, 0, 8}, {4, 0, 0});
        add("wall", {corner, 0, -4}, {4, 0, 0}, {0, 4, 0});
        for (int i = 0; i < 6; ++i)
            add("bar", {corner + 0.7f + 0.5f * float(i), 0, 1}, {0.03f, 0, 0}, {0, 2, 0});
    }
    return std::move(builder).finish();
}

TEST_F(RepairTest, pixelsThatTheTermsHardlyMoveComeLast) {
    Rig rig(device(), {.size = {160, 96}, .shadowMapSize = 512}, whiteAndBlack());
    const auto coarse = rig.terms({.shadingRate = 6});
    const auto changedHalves = [&](float cap) {
        const auto values = rig.terms({.shadingRate = 6, .repair = cap});
        std::array<std::size_t, 2> halves{};
        for (std::size_t i = 0; i < values.size(); ++i)
            halves[i % 160 / 80] += values[i] != coarse[i];
        return halves;
    };
    const auto all = changedHalves(1);
    ASSERT_GT(all[0], 50u);
    ASSERT_GT(all[1], 50u) << "black ones are listed too";
    const auto half = changedHalves(0.5f * float(rig.frame.repairedPixels()) / (160 * 96));
    EXPECT_GT(half[0], 0.7 * double(all[0]));
    EXPECT_LT(half[1], 0.2 * double(all[1]));
}

TEST_F(RepairTest, eachTermHasItsOwnRate) {
    Rig rig(device(), {.size = {160, 96}, .shadowMapSize = 512, .noiseOctaves = 3});
    const auto full = rig.terms({});
    const auto differing = [&](const Levers& levers) {
        const auto values = rig.terms(levers);
        std::array<std::size_t, 3> count{};
        for (std::size_t i = 0; i < full.size(); ++i)
            for (int c = 0; c < 3; ++c) count[std::size_t(c)] += values[i][c] != full[i][c];
        return count;
    };
    for (std::size_t only = 0; only < budget::kTerms; ++only) {
        Levers levers{.shadingRate = 4, .split = {0, 0, 0}};
        levers.split[only] = 1;
        const auto count = differing(levers);
        for (std::size_t term = 0; term < budget::kTerms; ++term) {
            if (term == only)
                EXPECT_GT(count[term], 100u) << budget::kTermNames[term];
            else
                EXPECT_EQ(count[term], 0u) << budget::kTermNames[term];
        }
    }
    const auto two = differing({.shadingRate = 5, .split = {1, 0.5f, 0}});
    EXPECT_GT(two[0], 0u);
    EXPECT_GT(two[1], 0u);
    EXPECT_EQ(two[2], 0u);
}

TEST_F(RepairTest, noisePatternSpreadsOverItsRange) {
    Rig rig(device(),
            {.size = {160, 96}, .shadowMapSize = 512, .noiseOctaves = 5, .noiseScale = 0.5f});
    const auto values = rig.terms({});
    float least = 1, most = 0;
    for (const glm::vec4& v : values) {
        ASSERT_GE(v.z, 0);
        ASSERT_LE(v.z, 1);
        least = std::min(least, v.z);
        most = std::max(most, v.z);
    }
    EXPECT_LT(least, 0.35f);
    EXPECT_GT(most, 0.65f);
}

}  // namespace
}  // namespace lodestar::frame

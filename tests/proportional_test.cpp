// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include <lodestar/budget/proportional_controller.hpp>

using namespace lodestar::budget;

namespace {

/// A frame whose cost goes with its pixels, but for a fixed part.
double frameMs(double s, double pixels, double fixed) {
    return pixels * s * s + fixed;
}

struct Outcome {
    std::vector<double> scale, ms;
    double meanMs(std::size_t from) const {
        double sum = 0;
        for (std::size_t i = from; i < ms.size(); ++i) sum += ms[i];
        return sum / double(ms.size() - from);
    }
    /// How far S goes in all.
    double travel(std::size_t from) const {
        double sum = 0;
        for (std::size_t i = from; i < scale.size(); ++i) sum += std::abs(scale[i] - scale[i - 1]);
        return sum;
    }
    double spread(std::size_t from) const {
        const auto [low, high] = std::minmax_element(scale.begin() + long(from), scale.end());
        return *high - *low;
    }
};

Outcome simulate(ProportionalController& controller, double pixels, double fixed, int frames,
                 double noise = 0) {
    std::mt19937 random(1);
    std::normal_distribution<double> relative(1, noise > 0 ? noise : 1e-12);
    Outcome run;
    for (int i = 0; i < frames; ++i) {
        run.scale.push_back(controller.scale());
        run.ms.push_back(frameMs(controller.scale(), pixels, fixed));
        const double ms = run.ms.back() * std::max(0.1, relative(random));
        controller.next({.gpuMs = ms, .passes = {}, .intervalMs = ms});
    }
    return run;
}

TEST(Proportional, followsTheLawOfTheSource) {
    ProportionalController controller({.targetMs = 20, .k = 0.5}, 0.8);
    // t = (22 + 26) / 2 = 24: S' = 0.8 + 0.5 · 0.8 · (20 − 24) / 20
    const Levers levers = controller.next({.gpuMs = 22, .passes = {}, .intervalMs = 26});
    EXPECT_NEAR(controller.scale(), 0.72, 1e-12);
    EXPECT_EQ(levers.renderScale, AxisScale(0.72f));
    EXPECT_EQ(levers.shadingRate, 1);
}

TEST(Proportional, findsTheScaleThatMeetsTheTarget) {
    for (const double pixels : {15.0, 25.0, 40.0}) {
        ProportionalController controller({.targetMs = 16});
        const Outcome run = simulate(controller, pixels, 4, 60);
        const double wanted = std::clamp(std::sqrt((16 - 4) / pixels), 0.5, 1.0);
        EXPECT_NEAR(run.scale.back(), wanted, 0.01) << pixels;
    }
}

TEST(Proportional, neverOscillatesOnASteadyLoad) {
    ProportionalController controller({.targetMs = 16});
    const Outcome run = simulate(controller, 30, 2, 80);
    for (std::size_t i = 2; i < run.scale.size(); ++i)
        EXPECT_LE(run.scale[i], run.scale[i - 1] + 1e-9) << i;
    EXPECT_LT(run.spread(40), 1e-3);
}

TEST(Proportional, underVerticalSyncTheGpuTimeShowsTheRoomThereIs) {
    // The interval is held at the refresh; half of it is work.
    ProportionalController controller({.targetMs = 16.6}, 0.6);
    for (int i = 0; i < 60; ++i) {
        const double gpu = frameMs(controller.scale(), 12, 1);
        controller.next({.gpuMs = gpu, .passes = {}, .intervalMs = 16.6});
    }
    EXPECT_EQ(controller.scale(), 1);
}

TEST(Proportional, stallsOfTheCpuAreIgnored) {
    ProportionalController with({.targetMs = 16}, 0.8), without = with;
    with.next({.gpuMs = 15, .passes = {}, .intervalMs = 400});
    without.next({.gpuMs = 15, .passes = {}});
    EXPECT_EQ(with.scale(), without.scale());
    EXPECT_GT(with.scale(), 0.8);
}

TEST(Proportional, hysteresisRestsOnANoisyMachine) {
    ProportionalController eager({.targetMs = 16}), calm({.targetMs = 16, .hysteresis = 0.1});
    const Outcome a = simulate(eager, 30, 2, 300, 0.04), b = simulate(calm, 30, 2, 300, 0.04);
    EXPECT_LT(b.travel(50), 0.2 * a.travel(50));
    EXPECT_NEAR(b.meanMs(50), 16, 1.6);
}

TEST(Proportional, bandsHoldOneScaleThatMeetsTheTarget) {
    for (const double pixels : {18.0, 24.0, 31.0, 44.0}) {
        ProportionalController controller({.targetMs = 16, .bands = 5});
        const Outcome run = simulate(controller, pixels, 2, 120, 0.03);
        const std::set<double> last(run.scale.end() - 40, run.scale.end());
        EXPECT_EQ(last.size(), 1u) << pixels;
        EXPECT_LE(run.ms.back(), 16 * 1.1) << pixels;
        EXPECT_NEAR(std::fmod(*last.begin() - 0.5 + 1e-9, 0.1), 0, 1e-6) << pixels;
        // Smooth: a change takes frames.
        for (std::size_t i = 1; i < run.scale.size(); ++i)
            EXPECT_LE(std::abs(run.scale[i] - run.scale[i - 1]), 0.025 + 1e-9);
    }
}

TEST(Proportional, aLoadThatGrowsIsFollowed) {
    ProportionalController controller({.targetMs = 16});
    simulate(controller, 12, 2, 30);
    EXPECT_EQ(controller.scale(), 1);
    const Outcome run = simulate(controller, 30, 2, 40);
    EXPECT_NEAR(run.ms.back(), 16, 0.2);
    EXPECT_NEAR(run.ms[10], 16, 2.5);  // ten frames later
}

TEST(Proportional, saysWhenScaleCannotHelp) {
    ProportionalController controller({.targetMs = 16});
    simulate(controller, 5, 30, 60);
    EXPECT_EQ(controller.scale(), 0.5);
    EXPECT_TRUE(controller.saturated());
    simulate(controller, 5, 3, 60);
    EXPECT_FALSE(controller.saturated());
}

TEST(Proportional, supersamplesWhereThereIsRoom) {
    ProportionalController controller({.targetMs = 16, .most = 2});
    simulate(controller, 3, 1, 100);
    EXPECT_EQ(controller.scale(), 2);
}

TEST(Proportional, movesWhatItIsToldAndNothingElse) {
    const Levers given{
        .shadingRate = 2, .renderScale = 0.9f, .shadowScale = 0.6f, .layerScale = 0.8f};
    const ProportionalController alone({}, 0.7);
    const Levers one = alone.drive(given);
    EXPECT_EQ(one.renderScale, AxisScale(0.7f));
    EXPECT_EQ(one.layerScale, given.layerScale);
    EXPECT_EQ(one.shadowScale, given.shadowScale);
    EXPECT_EQ(one.shadingRate, 2);
    const ProportionalController others(
        {.least = 0.25, .controls = {.render = false, .layer = true, .shadow = true}}, 0.5);
    const Levers two = others.drive(given);
    EXPECT_EQ(two.renderScale, given.renderScale);
    EXPECT_FLOAT_EQ(two.layerScale, 0.4f);
    EXPECT_FLOAT_EQ(two.shadowScale, 0.3f);
    // Never below what a frame takes, nor above what was given.
    const ProportionalController least(
        {.least = 0.25, .controls = {.render = false, .layer = true, .shadow = true}}, 0.25);
    EXPECT_EQ(least.drive(given).layerScale, 0.25f);
    EXPECT_EQ(least.drive(given).shadowScale, 0.25f);
    const ProportionalController more({.most = 2, .controls = {.layer = true, .shadow = true}},
                                      1.5);
    EXPECT_EQ(more.drive(given).layerScale, given.layerScale);
    EXPECT_EQ(more.drive(given).shadowScale, given.shadowScale);
}

TEST(Proportional, anAxisGetsNoMoreThanItWasGiven) {
    const ProportionalController controller({.most = 1.5}, 1.2);
    EXPECT_EQ(controller.drive({.renderScale = {1.5f, 0.5f}}).renderScale, AxisScale(1.2f, 1));
    EXPECT_EQ(controller.drive({.renderScale = {1.1f, 1.5f}}).renderScale, AxisScale(1.1f, 1.2f));
}

TEST(Proportional, lightMapsChangeInStepsThatNoiseDoesNotMove) {
    ProportionalController controller({.targetMs = 16, .controls = {.shadow = true}});
    std::mt19937 random(1);
    std::normal_distribution<double> relative(1, 0.05);
    std::set<float> late;
    int changes = 0;
    float last = 1;
    for (int i = 0; i < 200; ++i) {
        const float now = controller.drive({}).shadowScale;
        EXPECT_EQ(now * 8, std::round(now * 8));
        changes += now != last;
        last = now;
        if (i > 40) late.insert(now);
        controller.update({.gpuMs = frameMs(controller.scale(), 30, 2) * relative(random)});
    }
    EXPECT_LE(changes, 4);
    EXPECT_EQ(late.size(), 1u);
}

TEST(Proportional, settlesWithAllOfThemControlled) {
    // The layer goes with S twice: it is a share of the frame's own grid.
    ProportionalController controller(
        {.targetMs = 16, .controls = {.layer = true, .shadow = true}});
    std::vector<double> ms;
    for (int i = 0; i < 100; ++i) {
        const Levers l = controller.drive({});
        const double s = double{l.renderScale.x}, layer = s * double{l.layerScale};
        ms.push_back(2 + 8 * s * s + 20 * layer * layer +
                     6 * double{l.shadowScale * l.shadowScale});
        controller.update({.gpuMs = ms.back(), .passes = {}, .intervalMs = ms.back()});
    }
    for (std::size_t i = 40; i < ms.size(); ++i) EXPECT_NEAR(ms[i], 16, 0.3) << i;
}

TEST(Proportional, refusesWhatMakesNoSense) {
    using C = ProportionalController;
    EXPECT_THROW(C({.targetMs = 0}), std::invalid_argument);
    EXPECT_THROW(C({.k = 1}), std::invalid_argument);
    EXPECT_THROW(C({.least = 0}), std::invalid_argument);
    EXPECT_THROW(C({.least = 0.9, .most = 0.8}), std::invalid_argument);
    EXPECT_THROW(C({.spike = 0.5}), std::invalid_argument);
    EXPECT_THROW(C({.hysteresis = NAN}), std::invalid_argument);
    EXPECT_THROW(C({.bands = -1}), std::invalid_argument);
    EXPECT_THROW(C({}, 1.5), std::invalid_argument);
    EXPECT_THROW(C({.controls = {.render = false}}), std::invalid_argument);
    C controller({});
    EXPECT_THROW(controller.next({.gpuMs = NAN}), std::invalid_argument);
    EXPECT_THROW(controller.next({.gpuMs = 1, .passes = {}, .intervalMs = -1}),
                 std::invalid_argument);
}

}  // namespace

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/split_model.hpp>

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace lodestar::budget {
namespace {

constexpr std::array<bool, kTerms> kAll{true, true, true};

/// A renderer of known costs.
struct World {
    double c = 100, surface = 8, grid = 10, repairFixed = 3;
    std::array<double, kTerms> k{200, 80, 20};
    std::array<double, kTerms> error{4, 1, 20};  ///< at r = 2
    std::array<double, kTerms> power{2.5, 1.5, 1};
    double listed = 0, texel = 0;  ///< what texels of S cost more, at r = 1
    double noise = 0, noiseOfRest = 0;
    std::mt19937 random{7};

    double ms(const Split& split) {
        const SplitSample sample = parts(split);
        return sample.ms * std::normal_distribution<double>(1, noise)(random);
    }
    SplitSample parts(const Split& split) {
        std::vector<float> grids;
        double sum = 0, rest = c;
        bool coarse = false;
        for (std::size_t i = 0; i < kTerms; ++i) {
            const double r = split.rates[i];
            sum += k[i] / (r * r);
            if (std::find(grids.begin(), grids.end(), split.rates[i]) == grids.end()) {
                grids.push_back(split.rates[i]);
                sum += (surface + (r > 1 ? texel : 0)) / (r * r);
                rest += r > 1 ? grid + listed / (r * r) : 0;
            }
            coarse |= r > 1;
        }
        if (coarse && split.repair > 0) {
            rest += repairFixed;
            sum += split.repair * surface;
            for (std::size_t i = 0; i < kTerms; ++i)
                if (split.rates[i] > 1) sum += split.repair * k[i];
        }
        rest *= std::normal_distribution<double>(1, noiseOfRest)(random);
        return {.split = split, .ms = sum + rest, .mse = mse(split), .termsMs = sum};
    }
    double mse(const Split& split) const {
        double sum = 0;
        for (std::size_t i = 0; i < kTerms; ++i)
            if (split.rates[i] > 1)
                sum += error[i] * std::pow(split.rates[i] / 2, power[i]) *
                       (split.repair > 0 ? 0.4 : 1);
        return sum;
    }
    std::vector<SplitSample> samples(std::vector<float> repairs = {0, 0.02f}) {
        std::vector<SplitSample> all;
        const auto add = [&](const Split& split) { all.push_back({split, ms(split), mse(split)}); };
        add({});
        for (const float repair : repairs)
            for (std::size_t i = 0; i < kTerms; ++i)
                for (const float rate : {1.5f, 2.f, 3.f, 4.f, 8.f, 12.f}) {
                    Split split{.repair = repair};
                    split.rates[i] = rate;
                    add(split);
                }
        for (const float rate : {2.f, 5.f}) add({{rate, rate, rate}, 0});
        return all;
    }
};

TEST(SplitModel, findsTheCostsOfARendererThatFollowsTheModel) {
    World world;
    const SplitModel model(world.samples(), kAll);
    EXPECT_NEAR(model.termMs(Term::shadow), 200, 1);
    EXPECT_NEAR(model.termMs(Term::ao), 80, 1);
    EXPECT_NEAR(model.termMs(Term::noise), 20, 1);
    EXPECT_NEAR(model.gridMs(), 10, 0.5);
    for (const Split& split : {Split{{3, 2, 6}, 0}, Split{{5, 5, 1}, 0.02f}, Split{{4, 4, 4}, 0}})
        EXPECT_NEAR(model.ms(split), world.ms(split), 0.01 * world.ms(split));
}

TEST(SplitModel, aGridOfItsOwnForALittleIsSeenToBeDearer) {
    // Where texels of S cost more than pixels, r = 1.25 saves nothing.
    World world{.listed = 20, .texel = 60};
    std::vector<SplitSample> samples;
    for (const SplitSample& sample : world.samples()) samples.push_back(world.parts(sample.split));
    const SplitModel model(samples, kAll);
    EXPECT_NEAR(model.termMs(Term::shadow), 200, 1);
    for (const Split& split : {Split{{1.25f, 4, 1.25f}, 0}, Split{{1, 4, 1}, 0}})
        EXPECT_NEAR(model.ms(split), world.ms(split), 0.01 * world.ms(split));
    EXPECT_GT(model.ms({{1, 1, 1.25f}, 0}), model.ms({}));
}

TEST(SplitModel, noiseOfOtherPassesDoesNotPassForACostOfTheTerms) {
    World world{.noiseOfRest = 0.2};
    std::vector<SplitSample> samples;
    for (const SplitSample& sample : world.samples()) samples.push_back(world.parts(sample.split));
    const SplitModel model(samples, kAll);
    EXPECT_NEAR(model.termMs(Term::shadow), 200, 1);
    EXPECT_NEAR(model.termMs(Term::ao), 80, 1);
    EXPECT_NEAR(model.termMs(Term::noise), 20, 1);
}

TEST(SplitModel, errorsOfTermsAddAndFollowTheirPowerLaw) {
    World world;
    const SplitModel model(world.samples(), kAll);
    for (const Split& split :
         {Split{{2.5f, 1, 1}, 0}, Split{{3, 7, 1}, 0.02f}, Split{{6, 5, 9}, 0}})
        EXPECT_NEAR(model.mse(split), world.mse(split), 1e-3 * world.mse(split));
    EXPECT_EQ(model.mse({}), 0);
    EXPECT_LT(model.mse({{1.1f, 1, 1}, 0}), model.mse({{1.5f, 1, 1}, 0}));
}

TEST(SplitModel, noiseOfTheClockDoesNotMakeACostNegative) {
    World world{.c = 90, .k = {60, 1, 0.2}, .noise = 0.1};
    const SplitModel model(world.samples(), kAll);
    EXPECT_GE(model.termMs(Term::ao), 0);
    EXPECT_GE(model.termMs(Term::noise), 0);
    EXPECT_GE(model.gridMs(), 0);
    EXPECT_NEAR(model.fullMs(), 160, 30);
}

TEST(SplitModel, refusesSamplesThatDoNotTell) {
    World world;
    auto samples = world.samples();
    auto noFull = std::vector(samples.begin() + 1, samples.end());
    EXPECT_THROW(SplitModel(noFull, kAll), std::invalid_argument);
    std::vector<SplitSample> oneTerm(samples.begin(), samples.begin() + 7);
    EXPECT_THROW(SplitModel(oneTerm, kAll), std::invalid_argument);
    EXPECT_NO_THROW(SplitModel(oneTerm, {true, false, false}));
    samples[3].ms = NAN;
    EXPECT_THROW(SplitModel(samples, kAll), std::invalid_argument);
    EXPECT_THROW(SplitModel(world.samples(), {true, true, false}), std::invalid_argument);
}

TEST(BestSplits, fitTheBudgetAndNoSplitOfTheGridIsBetter) {
    World world;
    const SplitModel model(world.samples(), kAll);
    for (const double share : {0.9, 0.6, 0.45, 0.4}) {
        const double budgetMs = share * model.fullMs();
        const auto best = bestSplits(model, budgetMs, 3);
        ASSERT_EQ(best.size(), 3u);
        EXPECT_LE(best[0].ms, budgetMs);
        EXPECT_LE(best[0].mse, best[1].mse);
        for (const float r : {1.f, 1.5f, 2.f, 3.f, 4.f, 6.f, 8.f})
            for (const float s : {1.f, 2.f, 4.f, 8.f})
                for (const float repair : {0.f, 0.02f}) {
                    const Split hand{{r, s, s}, repair};
                    if (world.ms(hand) <= budgetMs) {
                        EXPECT_LE(best[0].mse, 1.02 * world.mse(hand)) << r << ' ' << s;
                    }
                }
    }
}

TEST(BestSplits, leaveFineWhatCostsNothing) {
    World world{.k = {200, 80, 0.01}};
    const SplitModel model(world.samples(), kAll);
    const auto best = bestSplits(model, 0.55 * model.fullMs(), 1);
    EXPECT_EQ(best[0].split.rates[std::size_t(Term::noise)], 1);
}

TEST(BestSplits, areNotVariantsOfOneAnother) {
    World world;
    const SplitModel model(world.samples({0}), kAll);
    const auto best = bestSplits(model, 0.5 * model.fullMs(), 6, 0.45);
    ASSERT_EQ(best.size(), 6u);
    for (std::size_t i = 0; i < best.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            double apart = 0;
            for (std::size_t t = 0; t < kTerms; ++t)
                apart = std::max<double>(
                    apart, std::abs(std::log2(best[i].split.rates[t] / best[j].split.rates[t])));
            EXPECT_GE(apart, 0.44);
        }
}

TEST(BestSplits, giveTheFastestWhereNothingFits) {
    World world;
    const SplitModel model(world.samples(), kAll);
    const auto best = bestSplits(model, 1, 4);
    ASSERT_EQ(best.size(), 1u);
    EXPECT_GT(best[0].ms, 1);
    for (const float r : {1.f, 4.f, 8.f, 11.f})
        EXPECT_LE(best[0].ms, model.ms({{r, r, r}, 0}) + 1e-6);
    EXPECT_THROW(bestSplits(model, 0, 1), std::invalid_argument);
}

TEST(SplitModel, leversHoldTheRatesOfASplit) {
    for (const Split& split :
         {Split{}, Split{{4, 2, 1}, 0.02f}, Split{{1, 1, 6}, 0}, Split{{3, 3, 3}, 0.5f}}) {
        const Split back = splitOf(leversOf(split));
        EXPECT_EQ(back.repair, split.repair);
        for (std::size_t i = 0; i < kTerms; ++i) EXPECT_NEAR(back.rates[i], split.rates[i], 1e-5);
    }
}

}  // namespace
}  // namespace lodestar::budget

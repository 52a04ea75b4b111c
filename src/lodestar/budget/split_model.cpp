// SPDX-License-Identifier: Apache-2.0
#include <lodestar/budget/split_model.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>

namespace lodestar::budget {
namespace {

// The unknowns of a frame's time, in this order: C, U, L, R; P, T, K of each term.
constexpr std::size_t kFixed = 0, kGrid = 1, kListed = 2, kRepair = 3;
constexpr std::size_t kSurface = 4, kTexel = 5, kFirstTerm = 6;
constexpr std::size_t kUnknowns = kFirstTerm + kTerms;
using Row = std::array<double, kUnknowns>;
static_assert(kUnknowns == SplitModel::kCosts);

constexpr double kLeastMse = 1e-6;  // what an error of 0 counts as on the power law

void require(bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("SplitModel: ") + what);
}

bool isCoarse(float rate) {
    return rate > 1.0005f;
}

/// How often each unknown is in the time of a frame.
Row rowOf(const Split& split, const std::array<bool, kTerms>& present) {
    Row row{};
    row[kFixed] = 1;
    std::vector<float> grids;
    for (std::size_t i = 0; i < kTerms; ++i) {
        if (!present[i]) continue;
        const float rate = split.rates[i];
        const bool known = std::any_of(grids.begin(), grids.end(),
                                       [&](float other) { return std::abs(other - rate) < 1e-3f; });
        if (!known) grids.push_back(rate);
        row[kFirstTerm + i] = 1 / (double(rate) * rate);
    }
    bool coarse = false;
    for (const float rate : grids) {
        row[kSurface] += 1 / (double(rate) * rate);
        if (!isCoarse(rate)) continue;
        coarse = true;
        row[kGrid] += 1;
        row[kListed] += 1 / (double(rate) * rate);
        row[kTexel] += 1 / (double(rate) * rate);
    }
    if (coarse && split.repair > 0) {
        row[kRepair] = 1;
        row[kSurface] += split.repair;
        for (std::size_t i = 0; i < kTerms; ++i)
            if (present[i] && isCoarse(split.rates[i])) row[kFirstTerm + i] += split.repair;
    }
    return row;
}

bool isOfTerms(std::size_t unknown) {
    return unknown >= kSurface;
}

/// Least squares with no unknown below 0, by coordinate descent on the normal equations: they are
/// few, and so it converges at once whatever the samples leave undetermined.
Row solve(const std::vector<Row>& rows, const std::vector<double>& values) {
    std::array<Row, kUnknowns> normal{};
    Row right{};
    for (std::size_t s = 0; s < rows.size(); ++s)
        for (std::size_t i = 0; i < kUnknowns; ++i) {
            right[i] += rows[s][i] * values[s];
            for (std::size_t j = 0; j < kUnknowns; ++j) normal[i][j] += rows[s][i] * rows[s][j];
        }
    Row x{};
    for (int sweep = 0; sweep < 20000; ++sweep) {
        double moved = 0;
        for (std::size_t i = 0; i < kUnknowns; ++i) {
            if (normal[i][i] <= 0) continue;
            double rest = right[i];
            for (std::size_t j = 0; j < kUnknowns; ++j)
                if (j != i) rest -= normal[i][j] * x[j];
            const double next = std::max(rest / normal[i][i], 0.0);
            moved = std::max(moved, std::abs(next - x[i]));
            x[i] = next;
        }
        if (moved < 1e-9) break;
    }
    return x;
}

double dot(const Row& a, const Row& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// 1, 1.25, 1.5, 1.75, 2, 2.5, 3, 3.5, 4, 5, …: four an octave. Whole rates are among them, at
/// which the centres of texels fall alike on the pixels of every texel: they do better than those
/// beside.
std::vector<float> ratesUpTo(float largest) {
    std::vector<float> rates;
    for (float octave = 1; octave <= largest; octave *= 2)
        for (const float step : {1.0f, 1.25f, 1.5f, 1.75f})
            if (step * octave <= largest) rates.push_back(step * octave);
    return rates;
}

double apartInOctaves(const Split& a, const Split& b) {
    double apart = 0;
    for (std::size_t i = 0; i < kTerms; ++i)
        apart = std::max(apart, std::abs(std::log2(double(a.rates[i]) / b.rates[i])));
    return apart;
}

}  // namespace

SplitModel::SplitModel(std::span<const SplitSample> samples, const std::array<bool, kTerms>& terms)
    : present(terms) {
    bool full = false;
    for (const SplitSample& sample : samples) {
        require(std::isfinite(sample.ms) && sample.ms > 0, "a sample's time must be above 0");
        require(std::isfinite(sample.mse) && sample.mse >= 0, "an error must not be negative");
        require(sample.termsMs >= 0 && sample.termsMs <= sample.ms, "terms are part of the time");
        require(sample.split.repair >= 0 && sample.split.repair <= 1, "repair is a share");
        std::size_t coarse = 0, which = 0;
        for (std::size_t i = 0; i < kTerms; ++i) {
            const float rate = sample.split.rates[i];
            require(std::isfinite(rate) && rate >= 1, "rates are at least 1");
            if (!isCoarse(rate)) continue;
            require(present[i], "a term that is not there was resized");
            ++coarse;
            which = i;
        }
        full |= coarse == 0;
        // Samples with more coarse terms help to fit the times alone.
        if (coarse == 1)
            curves[{sample.split.repair, which}].push_back(
                {sample.split.rates[which], std::max(sample.mse, kLeastMse)});
    }
    require(full, "one sample must have all terms fine");
    for (const float repair : repairs())
        for (std::size_t i = 0; i < kTerms; ++i)
            require(!present[i] || curves.contains({repair, i}),
                    "each term must be measured coarse, with each repair");
    for (auto& [key, points] : curves)
        std::sort(points.begin(), points.end(),
                  [](const Point& a, const Point& b) { return a.rate < b.rate; });
    fitTimes(samples);
}

std::vector<float> SplitModel::repairs() const {
    std::vector<float> all{0};
    for (const auto& [key, points] : curves)
        if (std::find(all.begin(), all.end(), key.repair) == all.end()) all.push_back(key.repair);
    return all;
}

void SplitModel::fitTimes(std::span<const SplitSample> samples) {
    const bool apart = std::all_of(samples.begin(), samples.end(),
                                   [](const SplitSample& sample) { return sample.termsMs > 0; });
    std::vector<Row> rows;
    std::vector<double> values;
    for (const SplitSample& sample : samples) {
        // A machine's noise is a share of the time: so are the residuals.
        Row terms = rowOf(sample.split, present), rest{};
        for (double& value : terms) value /= sample.ms;
        if (!apart) {
            rows.push_back(terms);
            values.push_back(1);
            continue;
        }
        for (std::size_t i = 0; i < kUnknowns; ++i)
            if (!isOfTerms(i)) std::swap(terms[i], rest[i]);
        rows.insert(rows.end(), {terms, rest});
        values.insert(values.end(), {sample.termsMs / sample.ms, 1 - sample.termsMs / sample.ms});
    }
    costs = solve(rows, values);
}

double SplitModel::ms(const Split& split) const {
    return dot(rowOf(split, present), costs);
}

double SplitModel::fixedMs() const {
    return costs[kFixed];
}

double SplitModel::gridMs() const {
    return costs[kGrid];
}

double SplitModel::termMs(Term term) const {
    return costs[kFirstTerm + static_cast<std::size_t>(term)];
}

double SplitModel::mse(const Split& split) const {
    double sum = 0;
    for (std::size_t i = 0; i < kTerms; ++i) {
        const double rate = split.rates[i];
        if (!present[i] || !isCoarse(split.rates[i])) continue;
        const auto curve = curves.find({split.repair, i});
        require(curve != curves.end(), "this repair was not measured");
        const std::vector<Point>& points = curve->second;
        // Below the first sample the error goes to 0 as the square of the step (r − 1).
        if (rate <= points.front().rate) {
            const double part = (rate - 1) / (points.front().rate - 1);
            sum += points.front().mse * part * part;
            continue;
        }
        if (points.size() == 1) {
            const double part = (rate - 1) / (points.front().rate - 1);
            sum += points.front().mse * part * part;
            continue;
        }
        auto above = std::find_if(points.begin(), points.end(),
                                  [&](const Point& point) { return point.rate >= rate; });
        if (above == points.end()) --above;
        const Point &a = *(above - 1), &b = *above;
        const double slope = std::log(b.mse / a.mse) / std::log(b.rate / a.rate);
        sum += a.mse * std::pow(rate / a.rate, slope);
    }
    return sum;
}

float SplitModel::largestRate(Term term) const {
    double largest = 1;
    for (const auto& [key, points] : curves)
        if (key.term == static_cast<std::size_t>(term))
            largest = std::max(largest, points.back().rate);
    return static_cast<float>(largest);
}

std::vector<RatedSplit> bestSplits(const SplitModel& model, double budgetMs, std::size_t count,
                                   double apart) {
    if (!(budgetMs > 0)) throw std::invalid_argument("bestSplits: the budget must be above 0");
    std::array<std::vector<float>, kTerms> rates;
    for (std::size_t i = 0; i < kTerms; ++i) rates[i] = ratesUpTo(model.largestRate(Term(i)));
    std::vector<RatedSplit> fitting;
    RatedSplit fastest{.ms = std::numeric_limits<double>::infinity()};
    for (const float repair : model.repairs())
        for (const float shadow : rates[0])
            for (const float ao : rates[1])
                for (const float noise : rates[2]) {
                    const Split split{{shadow, ao, noise}, repair};
                    // Nothing is repaired where nothing is coarse: such a split is there once.
                    if (repair > 0 && split.rates == TermRates{1, 1, 1}) continue;
                    const RatedSplit rated{split, model.ms(split), model.mse(split)};
                    if (rated.ms < fastest.ms) fastest = rated;
                    if (rated.ms <= budgetMs) fitting.push_back(rated);
                }
    if (fitting.empty()) return {fastest};
    std::sort(fitting.begin(), fitting.end(), [](const RatedSplit& a, const RatedSplit& b) {
        return a.mse != b.mse ? a.mse < b.mse : a.ms < b.ms;
    });
    std::vector<RatedSplit> best;
    for (const RatedSplit& candidate : fitting) {
        if (best.size() == count) break;
        const bool isNew = std::none_of(best.begin(), best.end(), [&](const RatedSplit& other) {
            return other.split.repair == candidate.split.repair &&
                   apartInOctaves(other.split, candidate.split) < apart;
        });
        if (isNew) best.push_back(candidate);
    }
    return best;
}

Levers leversOf(const Split& split) {
    Levers levers{.shadingRate = *std::max_element(split.rates.begin(), split.rates.end()),
                  .repair = split.repair};
    for (std::size_t i = 0; i < kTerms; ++i)
        levers.split[i] =
            levers.shadingRate > 1 ? (split.rates[i] - 1) / (levers.shadingRate - 1) : 1.0f;
    return levers;
}

Split splitOf(const Levers& levers) {
    Split split{.repair = levers.repair};
    for (std::size_t i = 0; i < kTerms; ++i) split.rates[i] = levers.rate(Term(i));
    return split;
}

}  // namespace lodestar::budget

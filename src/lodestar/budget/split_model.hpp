// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include <lodestar/budget/levers.hpp>

/// Which term of the shading is resized, and how far (Yang et al. 2008 name the automated selection
/// of resized elements as future work): from a few measured frames to the split that costs least
/// error within a budget.
namespace lodestar::budget {

using TermRates = std::array<float, kTerms>;  ///< r of each term

/// A split of the shading: what one frame was, or may be, rendered with.
struct Split {
    TermRates rates{1, 1, 1};
    float repair = 0;  ///< Levers::repair

    bool operator==(const Split&) const = default;
};

/// A measured frame.
struct SplitSample {
    Split split;
    double ms = 0;   ///< what it took
    double mse = 0;  ///< mean squared error of its picture against full quality, in any one unit
    double termsMs = 0;  ///< of its time, what the terms took, repaired ones too; 0: not known
};

/// Time and error of any split, from samples in which one term is coarse, and for the times some
/// in which more are.
///
/// A frame takes C + Σ over its grids S of [(P + Σ K_i)/r² + U + (L + T)/r² where r > 1] + repair:
/// C is fixed, P what finding the surface at a texel costs at full rate, K_i the term i itself, U
/// reconstruction, L listing the texels of S, T what a texel costs more than a pixel; repair takes
/// a fixed R and its share of the K_i. These are fitted by least squares, none below 0. Where the
/// samples tell what the terms took of their time, P and the K_i are fitted to that alone with T,
/// and C, U, L and R to the rest: the noise of one part does not pass for the other.
///
/// The error of a term at r lies on the power law between the samples on either side; errors of
/// different terms add, since they fall on different pixels or have nothing to do with each other.
class SplitModel {
public:
    /// `present` says which terms the shading has: a term that is not there stays at r = 1.
    /// Throws std::invalid_argument unless there is a sample with all terms fine, and one a term
    /// with it alone coarse, for each of the repairs that the samples have (0 is one of them); for
    /// a rate below 1, times ≤ 0, errors < 0, or numbers that are not finite.
    SplitModel(std::span<const SplitSample>, const std::array<bool, kTerms>& present);

    double ms(const Split&) const;
    /// Of a repair that was measured. Past the largest rate measured it goes on by the last law.
    double mse(const Split&) const;

    double fullMs() const { return ms({}); }
    double fixedMs() const;     ///< C
    double gridMs() const;      ///< U
    double termMs(Term) const;  ///< K
    bool has(Term term) const { return present[static_cast<std::size_t>(term)]; }
    /// The largest rate of the term that was measured; 1 for a term that is not there.
    float largestRate(Term) const;
    std::vector<float> repairs() const;

    static constexpr std::size_t kCosts = 6 + kTerms;

private:
    struct Point {
        double rate, mse;
    };
    struct Key {
        float repair;
        std::size_t term;
        auto operator<=>(const Key&) const = default;
    };
    void fitTimes(std::span<const SplitSample>);

    std::array<bool, kTerms> present;
    std::array<double, kCosts> costs{};        ///< C, U, L, R; P, T, K of each term [ms]
    std::map<Key, std::vector<Point>> curves;  ///< by rate
};

/// A split with what the model says of it.
struct RatedSplit {
    Split split;
    double ms = 0, mse = 0;
};

/// The splits of least error whose frames take `budgetMs` at most, the best first, from all rates
/// 1, 1.25, 1.5, 1.75, 2, 2.5, …, four an octave. Any two of them differ by at least `apart`
/// octaves in some rate or in their repair. Where no split is fast enough: the fastest alone.
std::vector<RatedSplit> bestSplits(const SplitModel&, double budgetMs, std::size_t count,
                                   double apart = 0.45);

/// As the levers of a frame, which have one r and how much of it each term takes.
Levers leversOf(const Split&);
Split splitOf(const Levers&);

}  // namespace lodestar::budget

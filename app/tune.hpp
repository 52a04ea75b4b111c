// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include <lodestar/budget/budget.hpp>
#include <lodestar/budget/split_model.hpp>

#include "app/session.hpp"

/// Automatic selection of what is resized, and how far: measured on the scene itself.
namespace lodestar::app {

struct TuneOptions {
    budget::Budget budget{budget::Budget::Kind::relative, 0.5};
    float repair = 0;     ///< tried beside none at all
    float localRate = 0;  ///< Levers::localRate of all that is measured
    int rounds = 3;       ///< times each split is rendered; the median counts
    /// Splits that the model likes best, within the budget and within a little more or less: all
    /// are measured before one is taken.
    std::size_t finalists = 5;
};

/// A split that was rendered: what the model said, and what it was.
struct Finalist {
    budget::RatedSplit predicted;
    double ms = 0, psnrDb = 0;
};

struct Tuning {
    double fullMs = 0, targetMs = 0;
    std::vector<budget::SplitSample> samples;  ///< times are medians, errors in squared codes
    budget::SplitModel model;
    std::vector<Finalist> finalists;
    std::size_t chosen = 0;  ///< of them
    budget::Levers levers;   ///< the chosen one

    const Finalist& choice() const { return finalists[chosen]; }
};

/// Renders `splits` in turn from each camera, `rounds` times, and compares each picture with full
/// quality. Times (sums of the passes' medians) and squared errors are means over the cameras.
std::vector<budget::SplitSample> measureSplits(const gpu::Device&, frame::Frame&,
                                               const std::vector<scene::Camera>& cameras,
                                               const std::vector<budget::Split>& splits,
                                               const TuneOptions&, const char* what);

/// What each term of the frame costs, and does to the picture where it is coarse.
struct TermSamples {
    std::vector<budget::SplitSample> samples;
    budget::SplitModel model;
};
/// Fails when the shading has no expensive term.
Result<TermSamples> measureTerms(const gpu::Device&, frame::Frame&,
                                 const std::vector<scene::Camera>& cameras, const TuneOptions&);

/// Measures the splits that the model likes best and takes the one of least error that holds the
/// budget, the fastest where none does.
Tuning chooseSplit(const gpu::Device&, frame::Frame&, const std::vector<scene::Camera>& cameras,
                   const TuneOptions&, const TermSamples&);

/// Both, one after the other.
Result<Tuning> tune(const gpu::Device&, frame::Frame&, const std::vector<scene::Camera>& cameras,
                    const TuneOptions&);

double psnrOfMse(double mse);  ///< of squared codes [dB]

/// What is expensive, what its error is, and what was chosen: for people.
void printTuning(const Tuning&);

/// The settings file: the chosen rates, and what they were chosen from.
Json tuningJson(const Tuning&);

/// Reads the levers of a settings file.
Result<budget::Levers> readSettings(const std::filesystem::path&);

}  // namespace lodestar::app

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "app/budget_run.hpp"

/// What the commands that render say about their frames: quality, counts, validation.
namespace lodestar::app {

/// PSNR, SSIM (NaN for pictures too small for it) and FLIP.
QualityFigures qualityOf(const quality::RgbImage& reference, const quality::RgbImage& test);

/// The sampled pictures of a run judged against full quality.
struct RunQuality {
    std::vector<QualityFigures> frames;  ///< one for each sample
    QualityFigures median;
    double worstPsnrDb = 0;
    quality::RgbImage lastReference;  ///< the last sample at full quality
};

/// Renders each sample's camera at full quality and compares. `fps` is that of the run; `run` has
/// samples.
RunQuality judgeRun(const Session&, frame::Frame&, const Run& run);

/// How much of the scene there is, and how much of it the last picture of `frame` drew.
Json countsOf(const Session&, const frame::Frame& frame);

/// An error when the validation layers had anything to say.
Result<void> validationVerdict(const gpu::Device&);

}  // namespace lodestar::app

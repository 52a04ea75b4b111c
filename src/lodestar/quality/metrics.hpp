// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/quality/image.hpp>

/// Full-reference picture quality. All throw std::invalid_argument when the sizes differ or are 0.
namespace lodestar::quality {

/// Peak signal-to-noise ratio over all RGB codes, peak 255 [dB]; +infinity for identical pictures.
double psnr(const RgbImage& reference, const RgbImage& test);

/// The same over the pixels where `mask` (one byte a pixel) is not 0; NaN when there are none.
double psnr(const RgbImage& reference, const RgbImage& test, const std::vector<std::uint8_t>& mask);

/// Structural similarity (Wang et al. 2004) of the Rec. 601 luma: Gaussian 11×11 window, σ = 1.5,
/// K1 = 0.01, K2 = 0.03, range 255, population covariance, mean without the 5-pixel border.
/// 1 = identical. Pictures smaller than 11×11 throw std::invalid_argument.
double ssim(const RgbImage& reference, const RgbImage& test);

/// LDR-FLIP (Andersson et al. 2020) at 67.0206 pixels per degree: the error of each pixel, 0 … 1.
ScalarImage flipMap(const RgbImage& reference, const RgbImage& test);
/// Mean of the FLIP map: 0 = no visible difference.
double flip(const RgbImage& reference, const RgbImage& test);

/// A FLIP map in the magma colours.
RgbImage falseColor(const ScalarImage& error);

}  // namespace lodestar::quality

// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <limits>

#include <lodestar/quality/checks.hpp>
#include <lodestar/quality/metrics.hpp>

namespace lodestar::quality {
namespace {

double decibels(std::uint64_t squaredError, std::uint64_t samples) {
    if (samples == 0) return std::numeric_limits<double>::quiet_NaN();
    if (squaredError == 0) return std::numeric_limits<double>::infinity();
    return 10 * std::log10(255.0 * 255.0 * double(samples) / double(squaredError));
}

std::uint64_t squaredDifference(std::uint8_t a, std::uint8_t b) {
    const int difference = int(a) - int(b);
    return std::uint64_t(difference * difference);
}

}  // namespace

double psnr(const RgbImage& reference, const RgbImage& test) {
    requireSameSize(reference, "reference", test, "test");
    std::uint64_t squaredError = 0;
    for (std::size_t i = 0; i < reference.rgb.size(); ++i)
        squaredError += squaredDifference(reference.rgb[i], test.rgb[i]);
    return decibels(squaredError, reference.rgb.size());
}

double psnr(const RgbImage& reference, const RgbImage& test,
            const std::vector<std::uint8_t>& mask) {
    requireSameSize(reference, "reference", test, "test");
    if (mask.size() != reference.rgb.size() / 3)
        throw std::invalid_argument("mask: must hold width * height bytes");
    std::uint64_t squaredError = 0, samples = 0;
    for (std::size_t pixel = 0; pixel < mask.size(); ++pixel) {
        if (mask[pixel] == 0) continue;
        for (std::size_t i = 3 * pixel; i < 3 * pixel + 3; ++i)
            squaredError += squaredDifference(reference.rgb[i], test.rgb[i]);
        samples += 3;
    }
    return decibels(squaredError, samples);
}

}  // namespace lodestar::quality

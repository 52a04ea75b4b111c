// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>

#include <lodestar/quality/checks.hpp>
#include <lodestar/quality/metrics.hpp>
#include <lodestar/quality/separable.hpp>
#include <lodestar/shared/parallel.hpp>

// Wang, Bovik, Sheikh, Simoncelli: Image quality assessment: from error visibility to structural
// similarity. IEEE Transactions on Image Processing 13(4), 2004, equation 13.
namespace lodestar::quality {
namespace {

constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
constexpr double kC2 = (0.03 * 255) * (0.03 * 255);

/// Windows are averaged band by band, so that memory does not grow with the height of the picture.
constexpr int kBandRows = 128;

std::vector<double> windowTaps() {
    std::vector<double> taps = gaussianTaps(kRadius, 1 / (2 * kSigma * kSigma));
    const double sum = sumOf(taps);
    for (double& tap : taps) tap /= sum;
    return taps;
}

Plane<double> lumaOfRows(const RgbImage& image, int firstRow, int rows) {
    Plane<double> luma(image.width, rows);
    const std::uint8_t* rgb = image.at(0, firstRow);
    for (double& value : luma.values) {
        value = 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
        rgb += 3;
    }
    return luma;
}

Plane<double> product(const Plane<double>& a, const Plane<double>& b) {
    Plane<double> out(a.width, a.height);
    for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = a.values[i] * b.values[i];
    return out;
}

double sumOfSimilarities(const Plane<double>& a, const Plane<double>& b,
                         const std::vector<double>& taps) {
    const auto windowMean = [&](const Plane<double>& plane) {
        return filterColumns(filterRows(plane, taps), taps);
    };
    const Plane<double> meanA = windowMean(a), meanB = windowMean(b);
    const Plane<double> meanAA = windowMean(product(a, a)), meanBB = windowMean(product(b, b)),
                        meanAB = windowMean(product(a, b));
    double sum = 0;
    for (std::size_t i = 0; i < meanA.values.size(); ++i) {
        const double muA = meanA.values[i], muB = meanB.values[i];
        const double varianceA = meanAA.values[i] - muA * muA;
        const double varianceB = meanBB.values[i] - muB * muB;
        const double covariance = meanAB.values[i] - muA * muB;
        sum += (2 * muA * muB + kC1) * (2 * covariance + kC2) /
               ((muA * muA + muB * muB + kC1) * (varianceA + varianceB + kC2));
    }
    return sum;
}

}  // namespace

double ssim(const RgbImage& reference, const RgbImage& test) {
    requireSameSize(reference, "reference", test, "test");
    const int windowsAcross = reference.width - 2 * kRadius;
    const int windowsDown = reference.height - 2 * kRadius;
    if (windowsAcross < 1 || windowsDown < 1)
        throw std::invalid_argument("reference: SSIM needs at least 11 x 11 pixels");

    const std::vector<double> taps = windowTaps();
    std::vector<double> sums(std::size_t(windowsDown + kBandRows - 1) / kBandRows);
    parallelFor(sums.size(), [&](std::size_t band) {
        const int first = int(band) * kBandRows;
        const int rows = std::min(kBandRows, windowsDown - first) + 2 * kRadius;
        sums[band] = sumOfSimilarities(lumaOfRows(reference, first, rows),
                                       lumaOfRows(test, first, rows), taps);
    });
    const double sum = std::accumulate(sums.begin(), sums.end(), 0.0);
    return sum / (double(windowsAcross) * windowsDown);
}

}  // namespace lodestar::quality

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/quality/flicker.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <lodestar/quality/checks.hpp>

namespace lodestar::quality {
namespace {

/// A place between the pixels of a picture.
struct Sample {
    int x0, y0, x1, y1;
    float shareX, shareY;  ///< of x1 and y1
};

/// False outside the area that the pixels' centres span, and for what is not finite.
bool sampleAt(float x, float y, int width, int height, Sample& sample) {
    if (!(x >= 0 && y >= 0 && x <= float(width - 1) && y <= float(height - 1))) return false;
    sample.x0 = int(x);
    sample.y0 = int(y);
    sample.x1 = std::min(sample.x0 + 1, width - 1);
    sample.y1 = std::min(sample.y0 + 1, height - 1);
    sample.shareX = x - float(sample.x0);
    sample.shareY = y - float(sample.y0);
    return true;
}

float bilinear(const RgbImage& image, const Sample& s, int channel) {
    const auto row = [&](int y) {
        const float left = image.at(s.x0, y)[channel], right = image.at(s.x1, y)[channel];
        return left + s.shareX * (right - left);
    };
    const float upper = row(s.y0);
    return upper + s.shareY * (row(s.y1) - upper);
}

}  // namespace

double flicker(const RgbImage& referenceBefore, const RgbImage& reference,
               const RgbImage& testBefore, const RgbImage& test, const MotionField* motion) {
    requireSameSize(referenceBefore, "referenceBefore", reference, "reference");
    requireSameSize(testBefore, "testBefore", reference, "reference");
    requireSameSize(test, "test", reference, "reference");
    if (motion != nullptr &&
        (motion->width != reference.width || motion->height != reference.height ||
         motion->offsets.size() != std::size_t(2) * motion->width * motion->height))
        throw std::invalid_argument("motion: must hold two offsets for each pixel of the frames");

    double sum = 0;
    std::size_t samples = 0;
    for (int y = 0; y < reference.height; ++y)
        for (int x = 0; x < reference.width; ++x) {
            float beforeX = float(x), beforeY = float(y);
            if (motion != nullptr) {
                const std::size_t pixel = std::size_t(y) * motion->width + x;
                beforeX += motion->offsets[2 * pixel];
                beforeY += motion->offsets[2 * pixel + 1];
            }
            Sample before;
            if (!sampleAt(beforeX, beforeY, reference.width, reference.height, before)) continue;
            for (int channel = 0; channel < 3; ++channel) {
                const float changeOfTest =
                    float(test.at(x, y)[channel]) - bilinear(testBefore, before, channel);
                const float changeOfReference =
                    float(reference.at(x, y)[channel]) - bilinear(referenceBefore, before, channel);
                sum += std::abs(changeOfTest - changeOfReference);
            }
            samples += 3;
        }
    if (samples == 0) return std::numeric_limits<double>::quiet_NaN();
    return sum / (255.0 * double(samples));
}

}  // namespace lodestar::quality

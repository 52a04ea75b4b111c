// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>

#include <lodestar/quality/metrics.hpp>

namespace lodestar::quality {
namespace {

/// Magma (Smith and van der Walt, CC0) at every 17th of its 256 colours, 0xRRGGBB. Linear in
/// between stays within 3 codes of the full table.
constexpr std::uint32_t kMagma[] = {0x000004, 0x0b0924, 0x20114b, 0x3b0f70, 0x57157e, 0x721f81,
                                    0x8c2981, 0xa8327d, 0xc43c75, 0xde4968, 0xf1605d, 0xfa7f5e,
                                    0xfe9f6d, 0xfebf84, 0xfddea0, 0xfcfdbf};

void magma(float value, std::uint8_t* rgb) {
    constexpr int kLast = int(std::size(kMagma)) - 1;
    // Written so that NaN becomes 0.
    const float position = (value > 0 ? std::min(value, 1.0f) : 0.0f) * kLast;
    const int stop = std::min(int(position), kLast - 1);
    const float share = position - float(stop);
    for (int channel = 0; channel < 3; ++channel) {
        const int shift = 16 - 8 * channel;
        const float from = float(kMagma[stop] >> shift & 0xff);
        const float to = float(kMagma[stop + 1] >> shift & 0xff);
        rgb[channel] = std::uint8_t(std::lround(from + share * (to - from)));
    }
}

}  // namespace

RgbImage falseColor(const ScalarImage& error) {
    if (error.width <= 0 || error.height <= 0 ||
        error.values.size() != std::size_t(error.width) * error.height)
        throw std::invalid_argument("error: must hold width * height values, and at least one");
    RgbImage out(error.width, error.height);
    for (std::size_t i = 0; i < error.values.size(); ++i) magma(error.values[i], &out.rgb[3 * i]);
    return out;
}

}  // namespace lodestar::quality

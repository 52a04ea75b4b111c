// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lodestar::quality {

/// One channel in scanlines. Filters here return only what the kernel fully covers, so a caller who
/// wants the border kept pads its input by the kernel's radius, in the way its metric demands.
template <typename T>
struct Plane {
    int width = 0, height = 0;
    std::vector<T> values;

    Plane(int w, int h) : width(w), height(h), values(std::size_t(w) * h) {}
    T* row(int y) { return values.data() + std::size_t(y) * width; }
    const T* row(int y) const { return values.data() + std::size_t(y) * width; }
};

/// Correlates each row with `kernel`: the result is `kernel.size() - 1` narrower.
template <typename T>
Plane<T> filterRows(const Plane<T>& in, const std::vector<T>& kernel) {
    assert(in.width >= int(kernel.size()));
    Plane<T> out(in.width - int(kernel.size()) + 1, in.height);
    for (int y = 0; y < out.height; ++y) {
        T* to = out.row(y);
        for (std::size_t tap = 0; tap < kernel.size(); ++tap) {
            const T weight = kernel[tap];
            const T* from = in.row(y) + tap;
            for (int x = 0; x < out.width; ++x) to[x] += weight * from[x];
        }
    }
    return out;
}

/// Correlates each column with `kernel`: the result is `kernel.size() - 1` lower.
template <typename T>
Plane<T> filterColumns(const Plane<T>& in, const std::vector<T>& kernel) {
    assert(in.height >= int(kernel.size()));
    Plane<T> out(in.width, in.height - int(kernel.size()) + 1);
    for (int y = 0; y < out.height; ++y) {
        T* to = out.row(y);
        for (std::size_t tap = 0; tap < kernel.size(); ++tap) {
            const T weight = kernel[tap];
            const T* from = in.row(y + int(tap));
            for (int x = 0; x < out.width; ++x) to[x] += weight * from[x];
        }
    }
    return out;
}

/// exp(-x² · rate) at -radius … radius, not normalised.
inline std::vector<double> gaussianTaps(int radius, double rate) {
    std::vector<double> taps;
    for (int x = -radius; x <= radius; ++x) taps.push_back(std::exp(-rate * x * x));
    return taps;
}

inline double sumOf(const std::vector<double>& taps) {
    double sum = 0;
    for (double tap : taps) sum += tap;
    return sum;
}

}  // namespace lodestar::quality

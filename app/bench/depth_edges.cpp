// SPDX-License-Identifier: Apache-2.0
#include "app/bench/depth_edges.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lodestar::app {

std::vector<std::uint8_t> depthEdgeMask(std::span<const float> depth, int width, int height,
                                        float jump, int radius) {
    if (width < 1 || height < 1 || depth.size() != std::size_t(width) * std::size_t(height))
        throw std::invalid_argument("depthEdgeMask: depth must be width × height");
    std::vector<std::uint8_t> mask(depth.size());
    const auto index = [&](int x, int y) {
        return std::size_t(y) * std::size_t(width) + std::size_t(x);
    };
    const auto mark = [&](int x, int y) {
        for (int dy = -radius; dy <= radius; ++dy)
            for (int dx = -radius; dx <= radius; ++dx) {
                const int u = x + dx, v = y + dy;
                if (dx * dx + dy * dy <= radius * radius && u >= 0 && v >= 0 && u < width &&
                    v < height)
                    mask[index(u, v)] = 1;
            }
    };
    const auto differ = [&](float a, float b) {
        if ((a == 0) != (b == 0)) return true;
        return std::abs(a - b) > jump * std::min(a, b);
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float here = depth[index(x, y)];
            if (x + 1 < width && differ(here, depth[index(x + 1, y)])) mark(x, y), mark(x + 1, y);
            if (y + 1 < height && differ(here, depth[index(x, y + 1)])) mark(x, y), mark(x, y + 1);
        }
    return mask;
}

Region worstRegion(const quality::RgbImage& reference, const quality::RgbImage& test,
                   const std::vector<std::uint8_t>& mask, int width, int height) {
    const int w = reference.width, h = reference.height;
    if (test.width != w || test.height != h || mask.size() != std::size_t(w) * std::size_t(h))
        throw std::invalid_argument("worstRegion: pictures and mask must be of one size");
    const Region size{0, 0, std::min(width, w), std::min(height, h)};
    // Sums over all pixels above and left of a corner.
    std::vector<std::uint64_t> sums(std::size_t(w + 1) * std::size_t(h + 1));
    const auto sum = [&](int x, int y) -> std::uint64_t& {
        return sums[std::size_t(y) * std::size_t(w + 1) + std::size_t(x)];
    };
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            std::uint64_t error = 0;
            if (mask[std::size_t(y) * std::size_t(w) + std::size_t(x)] != 0)
                for (int c = 0; c < 3; ++c) {
                    const int d = int(reference.at(x, y)[c]) - int(test.at(x, y)[c]);
                    error += std::uint64_t(d * d);
                }
            sum(x + 1, y + 1) = error + sum(x, y + 1) + sum(x + 1, y) - sum(x, y);
        }
    Region worst = size;
    std::uint64_t most = 0;
    for (int y = 0; y + size.height <= h; ++y)
        for (int x = 0; x + size.width <= w; ++x) {
            const std::uint64_t inside = sum(x + size.width, y + size.height) + sum(x, y) -
                                         sum(x, y + size.height) - sum(x + size.width, y);
            if (inside > most) {
                most = inside;
                worst.x = x;
                worst.y = y;
            }
        }
    return worst;
}

quality::RgbImage cropsSideBySide(const std::vector<const quality::RgbImage*>& pictures,
                                  const Region& region, int zoom) {
    constexpr int kGap = 4;  // black, between the crops
    const int cropWidth = region.width * zoom;
    const int count = int(pictures.size());
    quality::RgbImage out(count * cropWidth + (count - 1) * kGap, region.height * zoom);
    for (int i = 0; i < count; ++i)
        for (int y = 0; y < out.height; ++y)
            for (int x = 0; x < cropWidth; ++x)
                std::copy_n(pictures[std::size_t(i)]->at(region.x + x / zoom, region.y + y / zoom),
                            3, out.at(i * (cropWidth + kGap) + x, y));
    return out;
}

}  // namespace lodestar::app

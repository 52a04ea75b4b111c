// SPDX-License-Identifier: Apache-2.0
#include <lodestar/upsample/upsample_reference.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lodestar::upsample {
namespace {

/// Uniform B-splines of order 2, 3 and 4 (tent, quadratic, cubic), centred, and the Gaussian, as
/// functions of the distance to a tap.
double domainFilter(Reconstruct kind, double distance) {
    const double d = std::abs(distance);
    switch (kind) {
        case Reconstruct::nearest:
            return 1;
        case Reconstruct::bilateral:
        case Reconstruct::bilinear:
        case Reconstruct::nearestDepth:
            return std::max(0.0, 1 - d);
        case Reconstruct::biquadratic:
            if (d <= 0.5) return 0.75 - d * d;
            return d < 1.5 ? (1.5 - d) * (1.5 - d) / 2 : 0;
        case Reconstruct::bicubic:
            if (d <= 1) return 2.0 / 3 - d * d + d * d * d / 2;
            return d < 2 ? (2 - d) * (2 - d) * (2 - d) / 6 : 0;
        case Reconstruct::gaussian:
            return std::exp(-d * d / (2 * 0.7 * 0.7));
    }
    throw std::invalid_argument("Reconstruct");
}

int tapCount(Reconstruct kind) {
    switch (kind) {
        case Reconstruct::nearest:
            return 1;
        case Reconstruct::bilateral:
        case Reconstruct::bilinear:
        case Reconstruct::nearestDepth:
            return 2;
        case Reconstruct::biquadratic:
            return 3;
        case Reconstruct::bicubic:
        case Reconstruct::gaussian:
            return 4;
    }
    throw std::invalid_argument("Reconstruct");
}

void check(const Sigmas& sigmas, const ReferenceInputs& in) {
    const auto holds = [](glm::ivec2 size, std::size_t count) {
        return size.x > 0 && size.y > 0 && std::size_t(size.x) * std::size_t(size.y) == count;
    };
    if (!(sigmas.z > 0) || !(sigmas.n > 0)) throw std::invalid_argument("Sigmas must be > 0");
    if (!(in.rate >= 1)) throw std::invalid_argument("ReferenceInputs::rate must be at least 1");
    if (!holds(in.coarseSize, in.coarse.size()) || !holds(in.fullSize, in.pixels.size()))
        throw std::invalid_argument("ReferenceInputs: spans and sizes differ");
}

double square(double x) {
    return x * x;
}

/// −ln of the range weights g(|n_H − n_L|, σn) · g(|z_H − z_L|, σz); the depth difference is taken
/// relative to z_H.
double unlikeness(const Sigmas& sigmas, const ReferencePixel& pixel, const ReferenceTexel& tap) {
    double sum = 0;
    if (pixel.depth <= 0)  // background is like background alone; it has no normal
        return std::isfinite(sigmas.z) && tap.depth > 0 ? 1 / (2 * square(sigmas.z)) : 0;
    if (std::isfinite(sigmas.z))
        sum += square((pixel.depth - tap.depth) / pixel.depth) / (2 * square(sigmas.z));
    if (std::isfinite(sigmas.n)) {
        const glm::dvec2 difference = foreshortened(pixel.normal) - tap.normal;
        sum += glm::dot(difference, difference) / (2 * square(sigmas.n));
    }
    return sum;
}

struct Tap {
    const ReferenceTexel* texel;
    double weight, unlike;
};

/// The mean of the taps where all differ in depth by less than 3 σz, else the least unlike one.
glm::dvec4 mostLikeInDepth(const Sigmas& sigmas, const ReferencePixel& pixel,
                           const std::vector<Tap>& taps) {
    const double perZ = pixel.depth > 0 ? 1 / pixel.depth : 0;
    double least = std::numeric_limits<double>::infinity(), most = 0;
    glm::dvec4 best{0}, mean{0};
    for (const Tap& tap : taps) {
        const double difference = std::abs(pixel.depth - tap.texel->depth) * perZ;
        if (difference < least) {
            least = difference;
            best = tap.texel->terms;
        }
        most = std::max(most, difference);
        mean += tap.weight * tap.texel->terms;
    }
    return most <= 3 * sigmas.z ? mean : best;
}

}  // namespace

glm::dvec2 foreshortened(glm::dvec3 normal) {
    return glm::dvec2(normal) / std::max(normal.z, 0.05);
}

AxisTaps axisTaps(Reconstruct kind, double position) {
    AxisTaps taps;
    taps.count = tapCount(kind);
    taps.first = static_cast<int>(std::floor(position - 0.5 * taps.count)) + 1;
    double sum = 0;
    for (int i = 0; i < taps.count; ++i)
        sum += taps.weights[i] = domainFilter(kind, position - (taps.first + i));
    for (double& weight : taps.weights) weight /= sum;
    return taps;
}

std::vector<glm::dvec4> upsampleReference(Reconstruct kind, const Sigmas& sigmas,
                                          const ReferenceInputs& in) {
    check(sigmas, in);
    const bool guided = kind != Reconstruct::bilinear && kind != Reconstruct::nearest &&
                        kind != Reconstruct::nearestDepth;
    std::vector<glm::dvec4> result;
    for (int y = 0; y < in.fullSize.y; ++y)
        for (int x = 0; x < in.fullSize.x; ++x) {
            const ReferencePixel& pixel = in.pixels[result.size()];
            const AxisTaps across = axisTaps(kind, (x + 0.5) / in.rate - 0.5);
            const AxisTaps down = axisTaps(kind, (y + 0.5) / in.rate - 0.5);
            std::vector<Tap> taps;
            double least = std::numeric_limits<double>::infinity();
            for (int j = 0; j < down.count; ++j)
                for (int i = 0; i < across.count; ++i) {
                    const int tx = std::clamp(across.first + i, 0, in.coarseSize.x - 1);
                    const int ty = std::clamp(down.first + j, 0, in.coarseSize.y - 1);
                    const ReferenceTexel& texel =
                        in.coarse[std::size_t(ty) * std::size_t(in.coarseSize.x) + std::size_t(tx)];
                    const double weight = across.weights[i] * down.weights[j];
                    const double unlike = guided ? unlikeness(sigmas, pixel, texel) : 0;
                    taps.push_back({&texel, weight, unlike});
                    if (weight > 1e-4) least = std::min(least, unlike);
                }
            if (kind == Reconstruct::nearestDepth) {
                result.push_back(mostLikeInDepth(sigmas, pixel, taps));
                continue;
            }
            glm::dvec4 sum{0};
            double weights = 0;
            for (const Tap& tap : taps) {
                const double w = tap.weight * std::exp(std::min(0.0, least - tap.unlike));
                sum += w * tap.texel->terms;
                weights += w;
            }
            result.push_back(sum / weights);
        }
    return result;
}

}  // namespace lodestar::upsample

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <glm/glm.hpp>

#include <lodestar/quality/checks.hpp>
#include <lodestar/quality/metrics.hpp>
#include <lodestar/quality/separable.hpp>
#include <lodestar/shared/parallel.hpp>

// Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: FLIP: A Difference Evaluator
// for Alternating Images. Proceedings of the ACM on Computer Graphics and Interactive Techniques
// 3(2), 2020. Its 2D kernels are all sums of products of 1D ones, and are applied so.
namespace lodestar::quality {
namespace {

/// A 0.7 m wide 3840-pixel display seen from 0.7 m.
constexpr double kPixelsPerDegree = 67.0206;

// The paper's constants, by its names.
constexpr float kQc = 0.7f, kPc = 0.4f, kPt = 0.95f, kQf = 0.5f;
constexpr double kW = 0.082;  ///< width of the feature detectors [degrees]

constexpr double kPi = 3.14159265358979323846;

/// Rows worked on at once: small enough to stay in cache, and memory does not grow with the height.
constexpr int kBandRows = 64;

float srgbToLinear(int code) {
    const double value = code / 255.0;
    return float(value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4));
}

/// Linear sRGB to CIE XYZ relative to the white of the display, so that white is (1, 1, 1).
glm::dmat3 relativeXyzFromLinear() {
    const auto xyzOf = [](double x, double y) { return glm::dvec3(x / y, 1, (1 - x - y) / y); };
    // Chromaticities of Rec. 709 and D65; the columns are scaled so that they add up to white.
    glm::dmat3 xyz(xyzOf(0.64, 0.33), xyzOf(0.30, 0.60), xyzOf(0.15, 0.06));
    const glm::dvec3 white = xyzOf(0.3127, 0.3290);
    const glm::dvec3 scale = glm::inverse(xyz) * white;
    for (int i = 0; i < 3; ++i) xyz[i] *= scale[i] / white;
    return xyz;
}

struct ColorSpaces {
    std::array<float, 256> linear;
    glm::mat3 relativeXyzFromLinear, linearFromRelativeXyz;
};

const ColorSpaces& colorSpaces() {
    static const ColorSpaces spaces = [] {
        ColorSpaces s;
        for (int code = 0; code < 256; ++code) s.linear[code] = srgbToLinear(code);
        const glm::dmat3 forward = quality::relativeXyzFromLinear();
        s.relativeXyzFromLinear = glm::mat3(forward);
        s.linearFromRelativeXyz = glm::mat3(glm::inverse(forward));
        return s;
    }();
    return spaces;
}

float labCurve(float t) {
    constexpr float kDelta = 6.0f / 29.0f;
    if (t > kDelta * kDelta * kDelta) return std::cbrt(t);
    return t / (3 * kDelta * kDelta) + 4.0f / 29.0f;
}

/// CIE L*a*b* with the Hunt effect: chroma counts in proportion to lightness.
glm::vec3 huntLab(const glm::vec3& linear) {
    const glm::vec3 xyz = colorSpaces().relativeXyzFromLinear * linear;
    const float x = labCurve(xyz.x), y = labCurve(xyz.y), z = labCurve(xyz.z);
    const float lightness = 116 * y - 16;
    return {lightness, 0.01f * lightness * 500 * (x - y), 0.01f * lightness * 200 * (y - z)};
}

float hyab(const glm::vec3& a, const glm::vec3& b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

std::vector<float> toFloat(const std::vector<double>& taps, double scale) {
    std::vector<float> out;
    for (double tap : taps) out.push_back(float(tap * scale));
    return out;
}

/// The kernels, one dimension each. `contrast…` are the sensitivity functions of the opponent
/// channels (the paper's table 1), blue-yellow's being the sum of two Gaussians.
struct Kernels {
    int radius = 0;  ///< of the largest: the padding of the bands
    std::vector<float> contrastY, contrastRedGreen, contrastBlueYellow[2];
    float blueYellowShare[2];
    std::vector<float> featureSmooth, featureEdge, featurePoint;
};

std::vector<double> contrastTaps(int radius, double b) {
    return gaussianTaps(radius, kPi * kPi / (b * kPixelsPerDegree * kPixelsPerDegree));
}

void fillContrastKernels(Kernels& kernels) {
    constexpr double kLargestB = 0.04;
    const int radius =
        int(std::ceil(3 * std::sqrt(kLargestB / (2 * kPi * kPi)) * kPixelsPerDegree));
    const auto unit = [&](double b) {
        const std::vector<double> taps = contrastTaps(radius, b);
        return toFloat(taps, 1 / sumOf(taps));
    };
    kernels.radius = std::max(kernels.radius, radius);
    kernels.contrastY = unit(0.0047);
    kernels.contrastRedGreen = unit(0.0053);

    // What each Gaussian contributes to the volume under the 2D sum, which is normalised as one.
    constexpr double kA[2] = {34.1, 13.5}, kB[2] = {0.04, 0.025};
    double volume[2];
    for (int i = 0; i < 2; ++i) {
        const double side = sumOf(contrastTaps(radius, kB[i]));
        volume[i] = kA[i] * std::sqrt(kPi / kB[i]) * side * side;
        kernels.contrastBlueYellow[i] = unit(kB[i]);
    }
    for (int i = 0; i < 2; ++i)
        kernels.blueYellowShare[i] = float(volume[i] / (volume[0] + volume[1]));
}

/// First and second derivatives of a Gaussian; what is above zero sums to 1, what is below to -1.
void fillFeatureKernels(Kernels& kernels) {
    const double sigma = 0.5 * kW * kPixelsPerDegree;
    const int radius = int(std::ceil(3 * sigma));
    const std::vector<double> smooth = gaussianTaps(radius, 1 / (2 * sigma * sigma));
    std::vector<double> edge = smooth, point = smooth;
    for (int x = -radius; x <= radius; ++x) {
        edge[x + radius] *= -x;
        point[x + radius] *= x * x / (sigma * sigma) - 1;
    }
    const auto balance = [](std::vector<double>& taps) {
        double above = 0, below = 0;
        for (double tap : taps) (tap > 0 ? above : below) += std::abs(tap);
        for (double& tap : taps) tap /= tap > 0 ? above : below;
    };
    balance(edge);
    balance(point);
    kernels.radius = std::max(kernels.radius, radius);
    kernels.featureSmooth = toFloat(smooth, 1 / sumOf(smooth));
    kernels.featureEdge = toFloat(edge, 1);
    kernels.featurePoint = toFloat(point, 1);
}

const Kernels& kernels() {
    static const Kernels all = [] {
        Kernels k;
        fillContrastKernels(k);
        fillFeatureKernels(k);
        return k;
    }();
    return all;
}

/// Some rows of a picture in YCxCz, with `Kernels::radius` pixels more on every side; outside the
/// picture its border is repeated.
struct Band {
    Plane<float> y, cx, cz;
};

Band loadBand(const RgbImage& image, int firstRow, int rows) {
    const int padding = kernels().radius;
    const ColorSpaces& spaces = colorSpaces();
    const int width = image.width + 2 * padding, height = rows + 2 * padding;
    Band band{{width, height}, {width, height}, {width, height}};
    for (int y = 0; y < height; ++y) {
        const int fromY = std::clamp(firstRow + y - padding, 0, image.height - 1);
        for (int x = 0; x < width; ++x) {
            const std::uint8_t* code = image.at(std::clamp(x - padding, 0, image.width - 1), fromY);
            const glm::vec3 xyz =
                spaces.relativeXyzFromLinear *
                glm::vec3(spaces.linear[code[0]], spaces.linear[code[1]], spaces.linear[code[2]]);
            band.y.row(y)[x] = 116 * xyz.y - 16;
            band.cx.row(y)[x] = 500 * (xyz.x - xyz.y);
            band.cz.row(y)[x] = 200 * (xyz.y - xyz.z);
        }
    }
    return band;
}

/// Filters with rowTaps ⊗ columnTaps, and cuts off the padding that a smaller kernel leaves.
Plane<float> filter(const Plane<float>& padded, const std::vector<float>& rowTaps,
                    const std::vector<float>& columnTaps) {
    const int spare = kernels().radius - int(rowTaps.size() / 2);
    const Plane<float> filtered = filterColumns(filterRows(padded, rowTaps), columnTaps);
    if (spare == 0) return filtered;
    Plane<float> out(filtered.width - 2 * spare, filtered.height - 2 * spare);
    for (int y = 0; y < out.height; ++y)
        std::copy_n(filtered.row(y + spare) + spare, out.width, out.row(y));
    return out;
}

/// What the eye resolves of the band, in Hunt-adjusted L*a*b* (section 4.1).
std::vector<glm::vec3> perceivedColors(const Band& band) {
    const Kernels& k = kernels();
    const ColorSpaces& spaces = colorSpaces();
    const Plane<float> y = filter(band.y, k.contrastY, k.contrastY);
    const Plane<float> cx = filter(band.cx, k.contrastRedGreen, k.contrastRedGreen);
    const Plane<float> wide = filter(band.cz, k.contrastBlueYellow[0], k.contrastBlueYellow[0]);
    const Plane<float> narrow = filter(band.cz, k.contrastBlueYellow[1], k.contrastBlueYellow[1]);
    std::vector<glm::vec3> colors(y.values.size());
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const float cz =
            k.blueYellowShare[0] * wide.values[i] + k.blueYellowShare[1] * narrow.values[i];
        const float luminance = (y.values[i] + 16) / 116;
        const glm::vec3 xyz(luminance + cx.values[i] / 500, luminance, luminance - cz / 200);
        colors[i] = huntLab(glm::clamp(spaces.linearFromRelativeXyz * xyz, 0.0f, 1.0f));
    }
    return colors;
}

struct Features {
    std::vector<float> edge, point;
};

/// Strength of edges and points in the unfiltered luminance (section 4.2).
Features features(const Band& band) {
    const Kernels& k = kernels();
    const auto strength = [&](const std::vector<float>& derivative) {
        const Plane<float> across = filter(band.y, derivative, k.featureSmooth);
        const Plane<float> down = filter(band.y, k.featureSmooth, derivative);
        std::vector<float> out(across.values.size());
        // The paper scales luminance to 0 … 1, which for a derivative is the division by 116.
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] =
                std::sqrt(across.values[i] * across.values[i] + down.values[i] * down.values[i]) /
                116;
        return out;
    };
    return {strength(k.featureEdge), strength(k.featurePoint)};
}

/// Colour difference to 0 … 1: most of the range for what is not huge (section 4.1.3).
float colorError(const glm::vec3& a, const glm::vec3& b) {
    static const float largest = std::pow(hyab(huntLab({0, 1, 0}), huntLab({0, 0, 1})), kQc);
    const float power = std::pow(hyab(a, b), kQc);
    const float knee = kPc * largest;
    if (power < knee) return kPt / knee * power;
    return kPt + (power - knee) / (largest - knee) * (1 - kPt);
}

void flipRows(const RgbImage& reference, const RgbImage& test, int firstRow, int rows, float* out) {
    const Band bandA = loadBand(reference, firstRow, rows), bandB = loadBand(test, firstRow, rows);
    const std::vector<glm::vec3> colorsA = perceivedColors(bandA), colorsB = perceivedColors(bandB);
    const Features featuresA = features(bandA), featuresB = features(bandB);
    for (std::size_t i = 0; i < colorsA.size(); ++i) {
        const float edge = std::abs(featuresA.edge[i] - featuresB.edge[i]);
        const float point = std::abs(featuresA.point[i] - featuresB.point[i]);
        // Rounding must not leave 0 … 1: a zero to a power below zero is no error measure.
        const float feature =
            std::min(1.0f, std::pow(std::max(edge, point) / std::sqrt(2.0f), kQf));
        out[i] = std::min(1.0f, std::pow(colorError(colorsA[i], colorsB[i]), 1 - feature));
    }
}

}  // namespace

ScalarImage flipMap(const RgbImage& reference, const RgbImage& test) {
    requireSameSize(reference, "reference", test, "test");
    ScalarImage map{reference.width, reference.height, {}};
    map.values.resize(std::size_t(map.width) * map.height);
    parallelFor(std::size_t(map.height + kBandRows - 1) / kBandRows, [&](std::size_t band) {
        const int first = int(band) * kBandRows;
        flipRows(reference, test, first, std::min(kBandRows, map.height - first),
                 map.values.data() + std::size_t(first) * map.width);
    });
    return map;
}

double flip(const RgbImage& reference, const RgbImage& test) {
    const ScalarImage map = flipMap(reference, test);
    double sum = 0;
    for (float error : map.values) sum += error;
    return sum / double(map.values.size());
}

}  // namespace lodestar::quality

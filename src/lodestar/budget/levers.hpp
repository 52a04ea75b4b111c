// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The governor: pure C++, no Vulkan, no clock. It is told what a frame cost and says what the next
/// may do.
namespace lodestar::budget {

/// The expensive, smooth terms of shading, each with its own rate.
enum class Term { shadow, ao, noise };
inline constexpr std::array<std::string_view, 3> kTermNames{"shadow", "ao", "noise"};
inline constexpr std::size_t kTerms = kTermNames.size();

/// The effects that are computed on a grid B of their own.
enum class Effect { ssao, dof, motionBlur };
inline constexpr std::array<std::string_view, 3> kEffectNames{"ssao", "dof", "motion-blur"};
inline constexpr std::size_t kEffects = kEffectNames.size();

/// A scale of each axis of a picture; a number means both.
struct AxisScale {
    float x = 1, y = 1;

    constexpr AxisScale() = default;
    constexpr AxisScale(float both) : x(both), y(both) {}
    constexpr AxisScale(float alongX, float alongY) : x(alongX), y(alongY) {}
    bool operator==(const AxisScale&) const = default;

    /// The one scale that has as many pixels.
    float mean() const { return x == y ? x : std::sqrt(x * y); }
    float largest() const { return std::max(x, y); }
    AxisScale atLeast(float least) const { return {std::max(x, least), std::max(y, least)}; }
    AxisScale atMost(const AxisScale& most) const {
        return {std::min(x, most.x), std::min(y, most.y)};
    }
};

/// What a frame may spend. Everything that decides writes this; everything that renders reads it.
struct Levers {
    float shadingRate = 1;  ///< r of the coarse terms: grid S is ⌈W/r⌉ × ⌈H/r⌉; 1 = full quality
    /// How much of the way from 1 to r each term goes: 0 = always fine, 1 = r.
    std::array<float, kTerms> split{1, 1, 1};
    /// At most this share of the pixels has its coarse terms evaluated anew, where no texel of S is
    /// like the pixel; 0 = none.
    float repair = 0;
    /// Above 0 only every second texel of S is evaluated where the terms of neighbours lie no
    /// further apart than this (0 … 1); 0 = all are.
    float localRate = 0;

    /// S: the frame is rendered at S·W × S·H, where each axis may have an S of its own, and scaled
    /// to W × H; above 1 it is supersampled.
    AxisScale renderScale = 1;

    /// Of the depth maps of sun and sky, of their texels a side: 0.25 … 1. A change redraws them.
    float shadowScale = 1;

    /// Of the grid that blended surfaces are rendered on, of O along each axis: 0.25 … 1.
    float layerScale = 1;

    /// The whole shading goes to grid S, not the expensive terms alone (the paper's full resizing).
    bool resizeAll = false;

    /// Pixels of O that share a texel of grid B, by effect: 1, 4, 16 or 64.
    std::array<std::uint32_t, kEffects> postRates{1, 1, 1};

    std::uint32_t postRate(Effect effect) const {
        return postRates[static_cast<std::size_t>(effect)];
    }
    float rate(Term term) const {
        return 1 + (shadingRate - 1) * split[static_cast<std::size_t>(term)];
    }
};

/// GPU time of one pass [ms].
struct PassCost {
    std::string name;
    double ms = 0;
};

/// What the last frame cost.
struct FrameCosts {
    double gpuMs = 0;              ///< first to last timestamp of the frame
    std::vector<PassCost> passes;  ///< in frame order
    double intervalMs = 0;         ///< from this frame's start to the next one's; 0 = unknown
};

}  // namespace lodestar::budget

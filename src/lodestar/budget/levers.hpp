// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

/// The governor: pure C++, no Vulkan, no clock. It is told what a frame cost and says what the next
/// may do.
namespace lodestar::budget {

/// What a frame may spend. Everything that decides writes this; everything that renders reads it.
struct Levers {
    float shadingRate = 1;  ///< r of the coarse terms: grid S is ⌈W/r⌉ × ⌈H/r⌉; 1 = full quality
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
};

}  // namespace lodestar::budget

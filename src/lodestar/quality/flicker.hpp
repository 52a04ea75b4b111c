// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <lodestar/quality/image.hpp>

namespace lodestar::quality {

/// Where each pixel's surface was one frame earlier: offsets [pixels] to add to the position of
/// pixel (x, y) of the current frame, rows from the top.
struct MotionField {
    int width = 0, height = 0;
    std::vector<float> offsets;  ///< x, y of each pixel; not finite = was not visible
};

/// How much more (or less) a test sequence changes from one frame to the next than its reference:
/// the mean over RGB of |ΔI_test − ΔI_ref| in units of the code range, 0 … 2. ΔI is a pixel of the
/// current frame minus the same surface's in the previous one, found bilinearly through `motion`
/// (null: the camera and the scene stand still). Pixels whose surface was outside the previous
/// frame, or not visible in it, are left out; NaN when that leaves none.
///
/// 0 means that the test changes exactly as its reference does; a constant error in every frame is
/// no flicker. Throws std::invalid_argument when sizes differ or are 0.
double flicker(const RgbImage& referenceBefore, const RgbImage& reference,
               const RgbImage& testBefore, const RgbImage& test,
               const MotionField* motion = nullptr);

}  // namespace lodestar::quality

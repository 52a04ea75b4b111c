// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include <lodestar/upsample/reconstruct.hpp>

/// The equation of Upsample in double precision, for tests. Free of Vulkan.
namespace lodestar::upsample {

/// A texel of grid S.
struct ReferenceTexel {
    glm::dvec4 terms{0};
    double depth = 0;      ///< linear view depth [scene units]; 0 = background
    glm::dvec2 normal{0};  ///< foreshortened()
};

/// What guides the filter at a pixel of grid O.
struct ReferencePixel {
    double depth = 0;
    glm::dvec3 normal{0, 0, 1};  ///< view space, unit length
};

/// (nx/nz, ny/nz), with nz kept at 0.05 or more.
glm::dvec2 foreshortened(glm::dvec3 normal);

/// The taps along one axis: `count` texels of S from `first` on (to be clamped to the grid), and
/// their domain weights, whose sum is 1.
struct AxisTaps {
    int first = 0, count = 1;
    std::array<double, 4> weights{};
};
/// `position` in texels of S, texel centres at integers.
AxisTaps axisTaps(Reconstruct, double position);

struct ReferenceInputs {
    std::span<const ReferenceTexel> coarse;  ///< coarseSize, rows from the top
    std::span<const ReferencePixel> pixels;  ///< fullSize
    glm::ivec2 coarseSize{1}, fullSize{1};
    double rate = 1;
};

/// Yang et al. 2008, eq. 1, at every pixel of O. Where all taps are so unlike the pixel that the
/// quotient would be 0/0, its limit: the most similar of those with a domain weight above 1e-4.
/// Throws std::invalid_argument as Upsample::record does, and for spans of another size.
std::vector<glm::dvec4> upsampleReference(Reconstruct, const Sigmas&, const ReferenceInputs&);

}  // namespace lodestar::upsample

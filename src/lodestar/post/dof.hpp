// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <lodestar/post/dof_params.h>
#include <lodestar/gpu/recorder.hpp>
#include <lodestar/post/dof_options.hpp>

namespace lodestar::post {

/// Depth of field (thesis §4.1): between the sharp picture and three of growing blur, which are
/// made on grid B, of the background and of the foreground apart. Large blurs are made at a
/// half and a quarter of its resolution.
class Dof {
public:
    /// `room` is the size of the largest grid B; `full` that of the largest grid O where colours
    /// are to be downsampled.
    Dof(const gpu::Device&, vk::Extent2D room, std::optional<vk::Extent2D> full = {});

    struct Inputs {
        gpu::View depth;  ///< grid O, R32_SFLOAT: linear view depth, 0 = background
        shared::EffectiveGrid grid;
        bool bilateral = true;  ///< texels of another blur than the pixel count next to nothing
        float pixelAspect = 1;  ///< width of a pixel of O, as shown, over its height
    };
    /// Blurs `color` (grid O, RGBA16_SFLOAT, storage and sampled) in place; its alpha stays.
    /// Nothing outside the grids is read. Passes "dof" (on B, with what is downsampled) and "dof
    /// combine". Throws std::invalid_argument for options out of range and, where
    /// colours are downsampled, for rates other than 1 (which leaves nothing to do), 2, 4 and 8.
    void record(gpu::Recorder&, const Inputs&, const DofOptions&, gpu::View color) const;

private:
    struct Level {
        gpu::Image across, blurred;
    };
    void recordDown(gpu::Recorder&, const Inputs&, const shared::DofParams&, gpu::View color) const;
    struct Blur {
        float sigma = 0;          // in texels of what is read
        std::uint32_t step = 1;   // of those for one that is written
        std::uint32_t texel = 1;  // texels of B for one that is written
    };
    using Plan = std::array<Blur, 3>;  // along one axis
    static Plan plan(float sigma, bool careful);
    /// Returns the three pictures.
    std::array<gpu::View, 3> recordBlur(gpu::Recorder&, vk::Extent2D size, const Plan& x,
                                        const Plan& y) const;

    vk::raii::Sampler pointSampler, linearSampler;
    gpu::Kernel layersOfPixels, layersOfQuads, layersOfDown, down, blur, resolve, combine,
        combineBlocks;
    gpu::Image sharp;  // in layers
    gpu::Image cocs;   // circles of confusion on grid B
    std::vector<Level> levels;
    std::vector<gpu::Image> halves;  // of grid O, where colours are downsampled
};

}  // namespace lodestar::post

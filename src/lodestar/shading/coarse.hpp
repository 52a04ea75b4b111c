// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/gpu/recorder.hpp>
#include <lodestar/gpu/texel_list.hpp>
#include <lodestar/scene/gpu_scene.hpp>
#include <lodestar/upsample/reconstruct.hpp>
#include <lodestar/upsample/repair.hpp>

namespace lodestar::shading {

/// Size of grid S: ⌈W/r⌉ × ⌈H/r⌉.
vk::Extent2D coarseExtent(vk::Extent2D full, float rate);

/// The expensive, smooth terms: how much of the sun (soft shadow) and of the sky (ambient
/// occlusion) a surface sees, and its procedural noise, evaluated on grid S from visibility (Yang
/// et al. 2008, §2.3, fine-grained resizing).
class Coarse {
public:
    /// Which of the terms: bits LS_TERM_…
    using Mask = std::uint32_t;

    /// `present`: those that there are; the others are left out of the shaders and are 1.
    explicit Coarse(const gpu::Device&, Mask present = shared::LS_ALL_TERMS);
    Mask present() const { return terms; }

    struct Inputs {
        gpu::View ids;             ///< grid O, R32_UINT: triangle ids
        gpu::View sunMap;          ///< D32_SFLOAT array of one layer, reversed
        gpu::View skyMaps;         ///< D32_SFLOAT array, a layer for each view of the sky
        const gpu::Buffer& view;   ///< shared::ViewParams
        const gpu::Buffer& light;  ///< shared::LightParams
        /// RG32_SFLOAT, of the extent of `ids`, for recordFull: where each is met, in NDC; none: at
        /// the centres of pixels
        std::optional<gpu::View> points = {};
        upsample::Packing packing = upsample::Packing::full;  ///< of texels of S
        const gpu::TileList* tiles = nullptr;  ///< of `ids`, for recordFull; none: all
    };
    /// Writes the part of `coarse` (RGBA32_UINT) that coarseExtent(ids, rate) names. The terms are
    /// evaluated where it shows a surface: those texels are listed in `covered`. With `step` 2
    /// every second texel of every second row alone, for upsample::Refine. Passes "list terms",
    /// "terms".
    void record(gpu::Recorder&, const scene::GpuScene&, const Inputs&, Mask, float rate,
                const gpu::TexelList& covered, gpu::View coarse, std::uint32_t step = 1) const;
    /// Writes the texels of that grid that are listed, which must show surfaces. Pass "terms".
    void recordListed(gpu::Recorder&, const scene::GpuScene&, const Inputs&, Mask, float rate,
                      const gpu::TexelList&, gpu::View coarse) const;
    /// r = 1: writes the terms of every pixel of O to `terms` (RGBA16_SFLOAT), nothing to upsample.
    /// Channels that the mask lacks keep what they hold; all are written for LS_ALL_TERMS.
    void recordFull(gpu::Recorder&, const scene::GpuScene&, const Inputs&, Mask,
                    gpu::View terms) const;
    /// Writes the terms of the pixels that `list` keeps, the same way. Pass "repair".
    void recordRepair(gpu::Recorder&, const scene::GpuScene&, const Inputs&, Mask,
                      const upsample::RepairList& list, gpu::View terms) const;

private:
    Mask terms;
    vk::raii::Sampler pointSampler;
    gpu::Image noPoints;  ///< what is bound where there are none
    gpu::Kernel full, fullMerge, fullPoints, repair, list, coarse;
};

}  // namespace lodestar::shading

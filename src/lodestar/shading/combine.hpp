// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scene/gpu_scene.hpp>
#include <lodestar/upsample/upsample.hpp>

namespace lodestar::shading {

struct CombineOptions {
    /// shared::LightParams has a colour that is shown in the place of the sky.
    bool backdrop = false;
    upsample::Reconstruct reconstruct = upsample::Reconstruct::bilateral;  ///< of terms on grid S
};

/// Shading at grid O: metallic-roughness under sun, sky and punctual lights, from rebuilt
/// attributes and the reconstructed coarse terms; the sky or backdrop where there is no surface.
class Combine {
public:
    Combine(const gpu::Device&, const scene::SceneFeatures&, const CombineOptions& = {});

    struct Inputs {
        const gpu::Buffer& view;              ///< shared::ViewParams
        const gpu::Buffer& light;             ///< shared::LightParams
        gpu::View depth, material, emissive;  ///< visibility::Surface
        gpu::View terms;            ///< RGBA16_SFLOAT: visibility of the sun, of the sky, pattern,
                                    ///< ambient light that the screen occludes
        gpu::View sky;              ///< octahedral radiance, a mip level per step of roughness
        const gpu::Buffer& lights;  ///< shared::GpuLight
        /// RG32_SFLOAT: where each pixel is met, in NDC; none: at its centre
        std::optional<gpu::View> points = {};
        const gpu::TileList* tiles = nullptr;  ///< of grid O; none: all
    };
    /// Writes linear radiance to every texel in the extent of `radiance` (RGBA16_SFLOAT), and in
    /// `tiles`. Its alpha is the share that Tonemap gives its curve: 1, but 0 for unlit materials
    /// and the backdrop, which show as authored.
    void record(gpu::Recorder&, const Inputs&, gpu::View radiance) const;

    /// The same, with terms that are reconstructed from grid S as upsample::Upsample would, in the
    /// place of `terms`; at the centres of pixels. Throws std::invalid_argument as
    /// upsample::Upsample::record does.
    void recordFromS(gpu::Recorder&, const Inputs&, const upsample::Upsample::Inputs& termsOnS,
                     const upsample::Sigmas&, const upsample::UpsampleOptions&,
                     gpu::View radiance) const;

    /// The same of the pixels that the list keeps, with `terms` again; at their centres.
    void recordRepaired(gpu::Recorder&, const Inputs&, const upsample::RepairList&,
                        gpu::View radiance) const;

private:
    std::vector<gpu::Binding> bindings(const Inputs&, gpu::View radiance) const;

    vk::raii::Sampler pointSampler, skySampler;
    gpu::Kernel kernel, atPoints, fromS, fromSWithList, repaired;
    gpu::Buffer noList;  ///< what is bound where no pixels are listed
};

}  // namespace lodestar::shading

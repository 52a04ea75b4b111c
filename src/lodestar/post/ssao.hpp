// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/post/effective_params.h>
#include <lodestar/gpu/recorder.hpp>
#include <lodestar/post/ssao_options.hpp>

namespace lodestar::post {

/// Screen-space ambient occlusion on grid B (thesis §4.2), ready for upsample::Upsample to bring it
/// to grid O.
class Ssao {
public:
    explicit Ssao(const gpu::Device&);

    struct Inputs {
        const gpu::Buffer& view;  ///< shared::ViewParams
        gpu::View depth;          ///< grid B, R32_SFLOAT: linear view depth, 0 = background
        gpu::View normal;         ///< grid B, R32_UINT: view-space normal, packNormal
        shared::EffectiveGrid grid;
    };
    /// Writes the texels of B (`grid.size`) of both images (RGBA32_UINT, packCoarse of
    /// coarse_texel.glsl): w is the share of the ambient light that is occluded, of `scratch`
    /// before the nine turns of the samples are averaged. Nothing outside B is read. Pass "ssao".
    /// Throws std::invalid_argument for options out of range.
    void record(gpu::Recorder&, const Inputs&, const SsaoOptions&, gpu::View scratch,
                gpu::View occlusion) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel gather, blur;
};

}  // namespace lodestar::post

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::visibility {

/// Where what a pixel shows was in the frame before: exact, from the triangle that it shows, the
/// transform that its instance had, the place of its corners and the view that there was. At any
/// resolution that has ids.
class Motion {
public:
    /// `deforms`: some vertices move within their instances.
    Motion(const gpu::Device&, bool deforms);

    struct Inputs {
        gpu::View ids;                              ///< R32_UINT: triangle ids, 0 = background
        const gpu::Buffer& view;                    ///< shared::ViewParams of this frame
        const gpu::TexelBuffer& previousInstances;  ///< GpuScene::instances, a frame ago
        /// GpuScene::vertices from firstDeformed() on, a frame ago. None: they were where they are.
        const gpu::TexelBuffer* previousVertices;
        glm::mat4 previousClipFromWorld;  ///< without jitter
    };
    /// Writes every texel in the extent of `ids` of `motion` (RGBA32_SFLOAT):
    /// xy: from where the surface is seen to where it was seen, in widths and heights of the
    ///     picture, y down, jitter taken off both; past all pictures where it was behind the eye
    /// z:  its linear view depth then [scene units]; 0 = background
    /// w:  1 + its instance; 0 = background
    /// Pass "motion".
    void record(gpu::Recorder&, const scene::GpuScene&, const Inputs&, gpu::View motion) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::visibility

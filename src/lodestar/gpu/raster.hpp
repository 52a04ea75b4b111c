// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/kernel.hpp>

namespace lodestar::gpu {

struct RasterInfo {
    std::string name;
    std::span<const std::uint32_t> vertex, fragment;  ///< SPIR-V; no fragment shader when empty
    std::vector<vk::Format> colors;
    vk::Format depth = vk::Format::eD32Sfloat;
    vk::CullModeFlags cull = vk::CullModeFlagBits::eBack;
    bool depthClamp = false;     ///< keep what lies before the near plane, at its depth
    std::uint32_t samples = 1;   ///< of the targets
    bool sampleShading = false;  ///< run the fragment shader once a sample
    std::vector<SlotArray> slots;
    std::uint32_t pushBytes = 0;
    Specialization constants;
};

/// A graphics pipeline without vertex buffers: shaders fetch what they need. Counter-clockwise is
/// the front, depth test GREATER (reversed depth), no blending; viewport and scissor are dynamic.
class RasterPipeline {
public:
    RasterPipeline(const Device&, const RasterInfo&);

    const PipelineLayout& layout() const { return pipelineLayout; }
    const vk::raii::Pipeline& pipeline() const { return handle; }

private:
    PipelineLayout pipelineLayout;
    vk::raii::Pipeline handle{nullptr};
};

}  // namespace lodestar::gpu

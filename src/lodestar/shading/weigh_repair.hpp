// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>
#include <lodestar/upsample/repair.hpp>

namespace lodestar::shading {

/// Ranks the pixels that Upsample lists for repair by what wrong terms would do to the picture: the
/// display's step between the least and the most light that the terms leave, from the pixel's own
/// material, normal, sun and sky.
class WeighRepair {
public:
    explicit WeighRepair(const gpu::Device&);

    struct Inputs {
        const gpu::Buffer& view;   ///< shared::ViewParams
        const gpu::Buffer& light;  ///< shared::LightParams
        gpu::View material;        ///< grid O, visibility::Surface
    };
    /// `terms`: those that are repaired, bits LS_TERM_… Comes between Upsample and RepairSelect;
    /// leaves the list visible to compute. Pass "weigh repair".
    void record(gpu::Recorder&, const Inputs&, std::uint32_t terms,
                const upsample::RepairList&) const;

private:
    vk::raii::Sampler sampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::shading

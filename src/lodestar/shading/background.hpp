// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::shading {

/// The sky, or one colour in its place, in tiles of grid O without a surface, for which nothing
/// else is then to be done.
class Background {
public:
    /// `backdrop`: shared::LightParams has a colour that is shown in the place of the sky.
    explicit Background(const gpu::Device&, bool backdrop = false);

    struct Inputs {
        const gpu::Buffer& view;   ///< shared::ViewParams
        const gpu::Buffer& light;  ///< shared::LightParams
        gpu::View sky;             ///< octahedral radiance, as of Combine
        const gpu::TileList& tiles;
    };
    /// Of one extent, that of grid O; what is written is what Rebuild, Coarse and Combine would.
    struct Outputs {
        gpu::View depth;  ///< R32_SFLOAT: 0
        /// RGBA16_SFLOAT: those of what nothing shades; none: nothing is to read them
        std::optional<gpu::View> terms;
        gpu::View radiance;  ///< RGBA16_SFLOAT, linear
    };
    /// Pass "background".
    void record(gpu::Recorder&, const Inputs&, const Outputs&) const;

private:
    vk::raii::Sampler skySampler;
    gpu::Kernel kernel, withoutTerms;
};

}  // namespace lodestar::shading

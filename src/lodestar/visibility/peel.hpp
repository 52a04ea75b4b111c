// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/visibility/peel_params.h>
#include <lodestar/geometry/cull.hpp>

namespace lodestar::visibility {

/// What the blended surfaces of a view show, one behind the other (depth peeling; Everitt 2001):
/// exact in every pixel whatever the order of the triangles, and shaded as all that is visible is,
/// from ids.
class Peel {
public:
    Peel(const gpu::Device&, const scene::SceneFeatures&);

    struct Targets {
        Targets(const gpu::Device&, vk::Extent2D room);
        std::vector<gpu::Image> ids;     ///< R32_UINT, front to back, 0 = nothing
        std::vector<gpu::Image> alphas;  ///< R32_SFLOAT
        std::vector<gpu::Image> depths;  ///< two, in turn
    };
    struct Inputs {
        const geometry::DrawList& list;  ///< culled for the view at `size`
        glm::mat4 clipFromWorld;
        gpu::View opaqueDepth;      ///< R32_SFLOAT: linear view depth of what is opaque, 0 = none
        vk::Extent2D size;          ///< part of the targets to draw to
        glm::vec2 textureScale{1};  ///< of the gradients of alphas; as Rebuild's
    };
    /// Draws LS_PEELS layers; the list is visible to raster and indirect. Leaves them visible to
    /// compute. Passes "peel".
    void record(gpu::Recorder&, const scene::GpuScene&, const Inputs&, const Targets&) const;

private:
    vk::raii::Sampler sampler, pointSampler;
    std::vector<gpu::RasterPipeline> first, further;  // one-sided, double-sided
};

}  // namespace lodestar::visibility

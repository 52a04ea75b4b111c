// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/geometry/cull.hpp>

namespace lodestar::visibility {

/// Captures visibility with the raster pipeline, one sample a pixel of the target: which triangle
/// (geometry's id, 0 = background) and at which depth. Alpha-masked surfaces are tested in place.
class CaptureSs {
public:
    enum class Writes { idsAndDepth, depthOnly };

    /// `depthOnly` also keeps what lies before the near plane, clamped to it: for shadow maps.
    CaptureSs(const gpu::Device&, const scene::SceneFeatures&, Writes = Writes::idsAndDepth);

    struct Target {
        gpu::View ids;    ///< R32_UINT, color attachment; unused by depthOnly
        gpu::View depth;  ///< D32_SFLOAT, reversed
        /// Of the whole picture, where the target holds only some rows of it.
        std::optional<vk::Viewport> viewport = {};
        glm::vec2 textureScale{1};  ///< of the gradients of alpha tests; as visibility::Rebuild's
    };
    using Phase = geometry::DrawPhase;
    /// Clears the target (but keeps it for the second phase) and draws `list`, whose contents the
    /// caller has made visible to raster and indirect.
    void record(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList& list,
                const glm::mat4& clipFromWorld, const Target&, const std::string& name,
                Phase = Phase::both) const;

private:
    Writes writes;
    vk::raii::Sampler sampler;
    std::vector<gpu::RasterPipeline> pipelines;  ///< one for each scene::DrawBin
};

/// Trilinear, repeating: how scene textures are read (anisotropic on hardware that has it).
vk::raii::Sampler makeTextureSampler(const gpu::Device&);

}  // namespace lodestar::visibility

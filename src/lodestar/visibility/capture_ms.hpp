// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <lodestar/geometry/cull.hpp>
#include <lodestar/visibility/samples.hpp>

namespace lodestar::visibility {

/// How multisample passes cover a pixel's s × s samples: each pass draws the geometry shifted, at
/// `samples` a pixel of the target in the standard pattern. One sample of that pattern lies in each
/// row and each column of its ordered grid, so shifts along x visit every cell once. For s = 8 the
/// target is twice as fine as grid B: fewer passes than shifts both ways at B would take, and
/// vertices snap half as far.
struct MultisamplePlan {
    std::uint32_t samples = 1;      ///< a pixel of the target; 1 = no plan for this device and s
    std::uint32_t pixels = 1;       ///< of the target, a side of a pixel of grid B
    std::vector<glm::vec2> shifts;  ///< of each pass [pixels of the target]
};
/// `deviceSamples` is Device::multisamples().
MultisamplePlan planMultisample(std::uint32_t deviceSamples, std::uint32_t side);

/// Captures visibility by several multisample passes at grid B (thesis §3.1), reading every sample:
/// as many samples as supersampling, with the raster pipeline's work a pixel done once for several.
/// Equal to supersampling but for where vertices snap to.
class CaptureMs {
public:
    /// Throws gpu::DeviceError where planMultisample has no plan.
    CaptureMs(const gpu::Device&, const scene::SceneFeatures&, std::uint32_t side);

    /// Working memory for bands of up to `rows` rows of grid B.
    struct Scratch {
        Scratch(const gpu::Device&, std::uint32_t width, std::uint32_t rows, std::uint32_t side);
        Scratch(const gpu::Device&, const MultisamplePlan&, vk::Extent2D band, std::uint32_t side);
        gpu::Image color, depth;  ///< multisampled, a pixel larger each way
        gpu::Image ids;           ///< grid C
    };

    /// Fills scratch.ids. `list` was culled for the band and a pixel of grid B around it, at grid
    /// C.
    void record(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList& list,
                const glm::mat4& clipFromWorld, vk::Extent2D base, const Band&,
                const Scratch&) const;

private:
    std::uint32_t side;
    MultisamplePlan plan;
    vk::raii::Sampler sampler, pointSampler;
    std::vector<gpu::RasterPipeline> pipelines;  ///< one for each scene::DrawBin
    gpu::Kernel gather;
};

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <lodestar/budget/levers.hpp>
#include <lodestar/frame/post_settings.hpp>
#include <lodestar/post/dof.hpp>
#include <lodestar/post/max_depth.hpp>
#include <lodestar/post/motion_blur.hpp>
#include <lodestar/post/ssao.hpp>
#include <lodestar/upsample/upsample.hpp>
#include <lodestar/visibility/expand.hpp>
#include <lodestar/visibility/rebuild.hpp>
#include <lodestar/visibility/sample_grid.hpp>

namespace lodestar::frame {

/// The picture on grid O so far.
struct PostPicture {
    const scene::GpuScene& scene;
    const gpu::Buffer& view;  ///< shared::ViewParams
    gpu::View ids;            ///< its extent is that of O
    const visibility::Surface& surfaces;
    /// What O was expanded from: where it is coarser than O its grid is B.
    const visibility::CompactRecord* record = nullptr;
    const visibility::Expand* expand = nullptr;
    float focus = 1;        ///< distance of what the camera looks at
    float pixelAspect = 1;  ///< width of a pixel of O, as shown, over its height
    float supersample = 1;  ///< pixels of O along an axis that become one: rates count from it
};

/// The effects of a frame: each takes its inputs on a grid B of its own, coarser than O, and is
/// brought back to O (thesis §3.4).
class PostChain {
public:
    /// `room` is the size of the largest grid O. Throws std::invalid_argument for settings out of
    /// range.
    PostChain(const gpu::Device&, const scene::GpuScene&, const PostSettings&,
              const upsample::Sigmas&, vk::Extent2D room);

    /// Occlusion of the ambient light → w of `terms` (grid O). Adds the passes "ssao" and
    /// "upsample" and those of grid B; leaves the terms visible to compute.
    void recordOcclusion(gpu::Recorder&, const PostPicture&, const budget::Levers&,
                         gpu::View terms);
    /// The visibility::Motion of this frame on grid O; without it there is no motion blur.
    void moved(std::optional<gpu::View> since) { motion = since; }
    /// Depth of field and motion blur in place in `radiance` (grid O). Adds the passes "dof …",
    /// "motion blur …" and those of grid B and leaves the radiance visible to compute.
    void recordLens(gpu::Recorder&, const PostPicture&, const budget::Levers&, gpu::View radiance);

private:
    /// Depth and normal on a grid B.
    struct Guides {
        shared::EffectiveGrid grid;
        gpu::View depth, normal;
        vk::Extent2D size() const { return {grid.size.x, grid.size.y}; }
    };
    bool fromRecord(const PostPicture&) const;
    Guides gridOf(const PostPicture&, std::uint32_t rate) const;
    /// Adds the passes "sample grid" and "grid B", or "max depth".
    Guides recordGuides(gpu::Recorder&, const PostPicture&, std::uint32_t rate);

    /// What the effects share: only where one has a rate above 1 is it written.
    struct Inputs {
        visibility::SampleGrid sampleGrid;
        visibility::Rebuild rebuild;
        gpu::Image ids, points;
        visibility::Surface surfaces;
        std::optional<post::MaxDepth> maxDepth;
    };
    struct Occlusion {
        post::Ssao pass;
        upsample::Upsample upsample;
        gpu::Image scratch, result;
    };
    /// An effect's targets, made for the finest grid B that was asked for.
    template <typename Pass>
    struct Sized {
        std::uint32_t side;
        Pass pass;
    };
    void recordDof(gpu::Recorder&, const PostPicture&, std::uint32_t rate, gpu::View radiance);
    vk::Extent2D roomOf(std::uint32_t side) const;
    Occlusion makeOcclusion(vk::Extent2D) const;
    static Inputs makeInputs(const gpu::Device&, const PostSettings&, vk::Extent2D room);

    const gpu::Device* device;
    PostSettings settings;
    upsample::Sigmas sigmas;
    vk::Extent2D room;
    Inputs inputs;
    std::optional<gpu::View> motion;
    std::optional<Sized<Occlusion>> occlusion;
    std::optional<Sized<post::Dof>> dof;
    std::optional<Sized<post::MotionBlur>> motionBlur;
};

}  // namespace lodestar::frame

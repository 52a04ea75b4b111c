// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/visibility/fragments_params.h>
#include <lodestar/scene/gpu_scene.hpp>
#include <lodestar/visibility/compact.hpp>
#include <lodestar/visibility/rebuild.hpp>

namespace lodestar::visibility {

/// What must be shaded for an anti-aliased picture at grid B (the thesis's primitive-driven
/// supersampling). The *main* fragment of a pixel is its representative, at the centroid of its
/// samples. Another triangle of the pixel that continues the surface of main fragments around
/// (same material and instance, normals within 11°, no step in depth) takes their radiance; the
/// others are *further* fragments.
struct FragmentSet {
    FragmentSet(const gpu::Device&, vk::Extent2D base, std::uint32_t capacity);

    std::uint32_t capacity;          ///< further fragments that there is room for, ≥ 1
    vk::Extent2D base;               ///< grid B
    gpu::Image ids, points;          ///< grid B, R32_UINT and RG32_SFLOAT: triangle and NDC
    gpu::Image moreIds, morePoints;  ///< the further ones, row after row
    gpu::Buffer counts;              ///< mapped: FragmentCounts
    gpu::Buffer mixed;               ///< pixels that list several triangles
    gpu::Buffer further;             ///< FurtherPixel
    gpu::Buffer weights;             ///< samples of each further fragment

    const shared::FragmentCounts& found() const { return *counts.mapped<shared::FragmentCounts>(); }
    bool overflowed() const { return found().further > capacity; }
    /// The rows of moreIds that hold the further fragments; at least one.
    vk::Extent2D moreExtent() const;
};

class Fragments {
public:
    /// For records of `side` × `side` samples a pixel.
    Fragments(const gpu::Device&, std::uint32_t side);

    /// Finds the main fragments and the mixed pixels. The caller has made the record visible to
    /// compute. Pass "fragments".
    void record(gpu::Recorder&, const CompactRecord&, const FragmentSet&) const;

    struct MainInputs {
        const gpu::Buffer& view;  ///< shared::ViewParams
        gpu::View depth, normal;  ///< grid B, of the main fragments, as Surface has them
        gpu::View radiance;       ///< RGBA16_SFLOAT
    };
    /// Writes `out` (grid B, RGBA16_SFLOAT, storage) but for what the further fragments add, and
    /// lists those: look at set.overflowed() once submitted. Pass "merge".
    void recordMerge(gpu::Recorder&, const scene::GpuScene&, const CompactRecord&,
                     const MainInputs&, const FragmentSet&, const gpu::Image& out) const;
    /// Adds the further fragments. `radiance` is theirs, as moreIds. Pass "resolve".
    void recordResolve(gpu::Recorder&, gpu::View radiance, const FragmentSet&,
                       const gpu::Image& out) const;

private:
    std::uint32_t side;
    vk::raii::Sampler sampler;
    gpu::Kernel find, merge, resolve;
};

}  // namespace lodestar::visibility

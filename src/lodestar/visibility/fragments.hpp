// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/scene/gpu_scene.hpp>
#include <lodestar/visibility/compact.hpp>

namespace lodestar::visibility {

/// What must be shaded for an anti-aliased picture at grid B (the thesis's primitive-driven
/// supersampling): each triangle a pixel lists once, at the centroid of its samples. Triangles that
/// continue a surface of the pixel (same material and instance, normals within 11°, no step in
/// depth) share its shading. The pixel's own representative is its main fragment.
struct FragmentSet {
    /// For `record` and others of its size and rate with no longer lists.
    FragmentSet(const gpu::Device&, const CompactRecord& record, std::uint32_t capacity);

    std::uint32_t capacity;          ///< further fragments that there is room for, ≥ 1
    vk::Extent2D base;               ///< grid B
    gpu::Image ids, points;          ///< grid B, R32_UINT and RG32_SFLOAT: triangle and NDC
    gpu::Image moreIds, morePoints;  ///< the further ones, row after row
    gpu::Buffer offsets;             ///< further fragments before each pixel; the total at the end
    gpu::Buffer weights;             ///< samples of each further fragment
    gpu::Buffer merges;              ///< which surface a node continues, while it is filled
    gpu::Buffer total;               ///< mapped: further fragments of the frame

    std::uint32_t needed() const { return *total.mapped<std::uint32_t>(); }
    /// The rows of moreIds that hold `needed()` fragments; at least one.
    vk::Extent2D moreExtent() const;
};

class Fragments {
public:
    Fragments(const gpu::Device&, std::uint32_t side);

    /// Counts the further fragments: `set.needed()` once submitted. The caller has made the record
    /// visible to compute.
    void recordCount(gpu::Recorder&, const scene::GpuScene&, const CompactRecord&,
                     const glm::mat4& clipFromWorld, glm::vec3 eye, FragmentSet& set) const;
    /// Fills `set`, after recordCount.
    void recordWrite(gpu::Recorder&, const scene::GpuScene&, const CompactRecord&,
                     const glm::mat4& clipFromWorld, glm::vec3 eye, FragmentSet& set) const;

private:
    void dispatch(gpu::Recorder&, const gpu::Kernel&, const scene::GpuScene&, const CompactRecord&,
                  const glm::mat4& clipFromWorld, glm::vec3 eye, FragmentSet& set) const;

    std::uint32_t side;
    gpu::Kernel count, write;
    gpu::PrefixSum prefixSum;
};

/// Blends the radiance of a pixel's fragments by their samples.
class Resolve {
public:
    Resolve(const gpu::Device&, std::uint32_t side);
    /// `main`, `out`: grid B; `more`: as FragmentSet::moreIds. RGBA16_SFLOAT.
    void record(gpu::Recorder&, const FragmentSet&, gpu::View main, gpu::View more,
                gpu::View out) const;

private:
    vk::raii::Sampler sampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::visibility

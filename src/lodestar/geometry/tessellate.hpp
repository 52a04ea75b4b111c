// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/geometry/cull.hpp>
#include <lodestar/gpu/prefix_sum.hpp>

namespace lodestar::geometry {

/// Refines displaced meshes (scene::Displacement) near the eye beyond their finest level: each of
/// their triangles that has an edge longer than CullView::edgePx pixels becomes a meshlet of 4, 16
/// or 64, written after those of the scene, so that ids and everything that reads them stay as they
/// are. An edge is divided by its own length and distance, whatever triangle asks: no cracks.
class Tessellate {
public:
    Tessellate(const gpu::Device&, const scene::GpuScene&);

    /// For the view that is culled next; nothing for scenes without displaced meshes, and where
    /// edgePx is 0. The view must be perspective.
    void record(gpu::Recorder&, const scene::GpuScene&, const CullView&) const;

    /// Refined triangles of the last view that there was no place for, which were drawn as they
    /// are: a crack may show beside them. Waits for the device.
    std::uint32_t dropped() const;

private:
    const gpu::Device* device;
    gpu::Kernel select, list, refine;
    gpu::PrefixSum prefixSum;
    gpu::Buffer params, offsets, entries, header;
};

}  // namespace lodestar::geometry

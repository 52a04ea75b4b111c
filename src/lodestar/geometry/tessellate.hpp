// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/geometry/cull.hpp>
#include <lodestar/gpu/prefix_sum.hpp>

namespace lodestar::geometry {

/// Refines displaced meshes (scene::Displacement) near the eye beyond their finest level: where an
/// octave of the relief has waves of at least CullView::wavePx pixels, each triangle becomes a
/// meshlet of 4, 16 or 64, written after those of the scene, so that ids and everything that reads
/// them stay as they are. An edge is divided by its distance alone, whatever triangle asks: no
/// cracks.
class Tessellate {
public:
    Tessellate(const gpu::Device&, const scene::GpuScene&);

    /// For the view that is culled next; nothing for scenes without displaced meshes, and where
    /// wavePx is 0. The view must be perspective.
    void record(gpu::Recorder&, const scene::GpuScene&, const CullView&) const;

    /// By what factor the shortest waves of the last view are longer than CullView::wavePx: above 1
    /// where more triangles should be refined than there are places for, infinite where none were.
    /// Waits for the device.
    float coarsenedBy() const;

private:
    const gpu::Device* device;
    gpu::Kernel count, mark, list, refine;
    gpu::PrefixSum prefixSum;
    gpu::Buffer params, offsets, entries, header;
    std::uint32_t capacity;
};

}  // namespace lodestar::geometry

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::upsample {

/// The pixels of grid O that no texel of S is like (Yang et al. 2008 name their repair as future
/// work), or whose texels of S disagree: Upsample lists them, RepairSelect keeps the worst.
struct RepairList {
    RepairList(const gpu::Device&, vk::Extent2D);

    vk::Extent2D size;   ///< of O, at most 2²⁶ pixels; may be made smaller for a frame
    gpu::Buffer header;  ///< shared::RepairHeader, its first words an indirect dispatch
    gpu::Buffer listed;  ///< all pixels listed: index | bin << 26
    gpu::Buffer kept;    ///< indices of the pixels kept
};

/// Keeps of the listed pixels the worst: whole bins of them and of one bin some, drawn by lot, so
/// that the choice does not depend on the order in which they were listed.
class RepairSelect {
public:
    explicit RepairSelect(const gpu::Device&);

    /// Empties the list; then visible to compute.
    static void clear(gpu::Recorder&, const RepairList&);
    /// `share` of the pixels of O at most are kept. Pass "select repair". Leaves the list visible
    /// to compute and indirect. Throws std::invalid_argument for a share outside 0 … 1.
    void record(gpu::Recorder&, const RepairList&, float share) const;

private:
    gpu::Kernel count, cut, compact;
};

}  // namespace lodestar::upsample

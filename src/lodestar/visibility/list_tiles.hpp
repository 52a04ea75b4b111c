// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/gpu/recorder.hpp>

namespace lodestar::visibility {

/// Which 8×8 tiles of a grid show a surface, and which show none: what is shaded need not be done
/// for the background, where a CPU driver, which runs both sides of a branch, would pay for it.
class ListTiles {
public:
    explicit ListTiles(const gpu::Device&);

    /// Lists the tiles of the extent of `ids` (R32_UINT, sampled, 0 = background): each in one of
    /// `covered` and `empty`, in no particular order. Both are visible to compute and indirect
    /// afterwards. Pass "list tiles".
    void record(gpu::Recorder&, gpu::View ids, const gpu::TileList& covered,
                const gpu::TileList& empty) const;

private:
    vk::raii::Sampler pointSampler;
    gpu::Kernel kernel;
};

}  // namespace lodestar::visibility

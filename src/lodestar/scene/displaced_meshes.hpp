// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <lodestar/scene/displacement.h>
#include <lodestar/scene/gpu_types.h>
#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

/// Which instances of a scene are displaced, and their meshlets.
struct DisplacedMeshes {
    std::vector<shared::GpuDisplaced> records;    ///< the first is that of all other instances
    std::vector<shared::GpuDisplacedPair> pairs;  ///< the first is unused; those of one together
    std::vector<std::uint32_t> ofInstance;        ///< record of each; empty where none is displaced
    std::size_t places = 0;                       ///< triangles that may be refined at a time
};

/// `meshes` and `lods` as uploaded. Throws std::invalid_argument for a displacement without a
/// wavelength, or with an amplitude that is no finite number ≥ 0.
DisplacedMeshes findDisplaced(const Scene&, std::span<const shared::GpuMesh> meshes,
                              std::span<const shared::GpuLod> lods);

}  // namespace lodestar::scene

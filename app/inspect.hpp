// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <array>

#include <lodestar/scene/mesh_lods.hpp>
#include <lodestar/scene/scene.hpp>
#include <lodestar/scene/texture_arrays.hpp>

#include "app/report_json.hpp"

namespace lodestar::app {

/// What there is in a scene and what it needs on the device.
struct Inspection {
    scene::TriangleCounts triangles;
    std::uint64_t vertices = 0, meshletsStored = 0, meshletsDrawn = 0;  ///< of the finest level
    struct Level {
        std::uint64_t meshes = 0;             ///< that have this level
        std::uint64_t stored = 0, drawn = 0;  ///< triangles; of meshes without it, their last
        float error = 0;                      ///< median over the meshes, relative to their radius
        /// Meshes by method.
        std::array<std::uint64_t, std::size_t(scene::LodMethod::sloppy) + 1> methods{};
    };
    std::vector<Level> levels;
    struct Materials {
        std::size_t opaque = 0, mask = 0, blend = 0, doubleSided = 0, unlit = 0, textured = 0;
    } materials;
    struct Layers {
        int width = 0, height = 0;
        std::uint32_t layers = 0, mipLevels = 0;
        scene::ColorSpace space = scene::ColorSpace::linear;
        std::uint64_t bytes = 0;
    };
    std::vector<Layers> textureArrays;
    scene::Bounds bounds;  ///< world space
    /// An estimate: geometry as imported, textures as the arrays they are packed into.
    std::vector<MemoryUse> memory;
};

/// `seconds` is the time of the animation at which the bounds are taken.
Inspection inspectScene(const scene::Scene&, double seconds);

/// Adds `lodestar inspect`.
void addInspect(CLI::App&, int& exitCode);

}  // namespace lodestar::app

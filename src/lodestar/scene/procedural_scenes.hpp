// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene::procedural {

inline constexpr std::uint64_t kMinGridTriangles = 2;
inline constexpr std::uint64_t kMaxGridTriangles = 100'000'000;

/// A vaulted hall, 17 m wide and 40 m long, with 30 columns, an open side for the sun, railings,
/// cables and lamps. No roof over the aisle at +x but rafters.
Scene buildColumns();

/// Spheres over a ground plane: roughness grows to the right, metallic from the front to the back.
Scene buildSpheres();

/// A height field of `triangles` (kMinGridTriangles … kMaxGridTriangles) triangles drawn, exact up
/// to 130,050 and within 0.5 % above; at most 16 meshes are stored, since the field repeats.
Scene buildGrid(std::uint64_t triangles);

inline constexpr std::uint64_t kMaxInstances = 20'000'000;
inline constexpr std::uint64_t kMountainObjects = 8000;

/// `count` objects of four kinds, one a square metre of a plain. The camera `near` sees about
/// 10,000 of them however many there are.
Scene buildInstances(std::uint64_t count);

/// A height field of 1 km² of ridges about a valley, with `objects` conifers and rocks where they
/// would be (Rakos 2010's demo).
Scene buildMountains(std::uint64_t objects);

}  // namespace lodestar::scene::procedural

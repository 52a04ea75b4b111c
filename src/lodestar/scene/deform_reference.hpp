// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/scene/scene.hpp>

namespace lodestar::scene {

struct DeformedVertex {
    glm::dvec3 position, normal, tangent;  ///< directions at unit length
};

/// The vertices of an instance as joints and morph weights have them (glTF 2.0, 3.7.2 and 3.7.3),
/// in the space of its mesh, or in the world where it has a skin. In double precision: what Deform
/// does on the device, for tests.
std::vector<DeformedVertex> deformReference(const Scene&, const Instance&, const Pose&);

}  // namespace lodestar::scene

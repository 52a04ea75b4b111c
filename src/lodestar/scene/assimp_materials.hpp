// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/scene/assimp_images.hpp>
#include <lodestar/scene/scene.hpp>

struct aiMaterial;

namespace lodestar::scene {

/// What of a material the file format decides.
struct MaterialHabits {
    bool unlitMeansUnlit = true;  ///< OBJ files say "illum 0" without meaning it
};

/// An assimp material as metallic-roughness. Classic (Phong) ones become dielectrics: the diffuse
/// colour is taken for sRGB, as every format without a colour space means it; roughness is that of
/// the Beckmann lobe as wide as the Phong one. Adds textures to `scene`.
Material convertMaterial(const aiMaterial&, AssimpImages&, const MaterialHabits&, Scene& scene);

}  // namespace lodestar::scene

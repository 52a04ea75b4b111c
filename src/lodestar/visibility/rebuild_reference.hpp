// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <glm/glm.hpp>

/// Double-precision twin of triangle.glsl and of the interpolation in rebuild.comp, for tests. It
/// goes another way: instead of edge functions about the pixel it inverts the triangle's matrix.
namespace lodestar::visibility::reference {

/// A triangle as a ray through the screen meets it. The winding does not matter.
struct Triangle {
    std::array<glm::dvec3, 3> world;   ///< positions
    std::array<glm::dvec3, 3> normal;  ///< world, any length
    std::array<glm::dvec2, 3> uv;
};

/// Weights of the vertices where the ray through a point of the screen meets the triangle's plane.
struct Weights {
    glm::dvec3 at;      ///< sum 1; all ≥ 0 inside the triangle
    glm::dvec3 dx, dy;  ///< change per NDC unit
    double depth = 0;   ///< linear view depth [scene units]; < 0 behind the eye
};

/// The point (x, y, w) of clip space seen at `ndc` is proportional to (ndc, 1), and is Σ b_i v_i of
/// the clip-space vertices v_i: so b ∝ M⁻¹ (ndc, 1) with the v_i as columns of M (Olano & Greer
/// 1997). NaN or infinite for a triangle seen exactly edge-on.
Weights weightsAt(const std::array<glm::dvec4, 3>& clip, glm::dvec2 ndc);

/// The surface seen through a point of the picture.
struct Surface {
    Weights weights;
    glm::dvec3 position;        ///< world
    glm::dvec3 normal;          ///< world, unit length, as the vertices have it
    glm::dvec2 uv, uvDx, uvDy;  ///< the last two per pixel
};

/// `point` in pixels from the top left (a pixel's centre is at + ½), `size` in pixels.
Surface rebuild(const Triangle&, const glm::dmat4& clipFromWorld, glm::dvec2 point,
                glm::dvec2 size);

}  // namespace lodestar::visibility::reference

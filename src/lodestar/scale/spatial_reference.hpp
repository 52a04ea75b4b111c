// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include <lodestar/scale/filter.hpp>

/// Double-precision twin of spatial.comp, for tests.
namespace lodestar::scale::reference {

struct Picture {
    glm::ivec2 size;
    std::vector<glm::dvec3> texels;  ///< rows from the top

    /// Past the edge the nearest texel.
    glm::dvec3 at(glm::ivec2 texel) const;
};

/// `source` at another size. All filters but those with noise.
Picture scale(const Picture& source, glm::ivec2 size, Filter);

}  // namespace lodestar::scale::reference

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <lodestar/scene/scene.hpp>

/// How a coarser triangle list over the vertices of a mesh differs from the mesh.
namespace lodestar::scene {

using Indices = std::vector<std::uint32_t>;

/// The vertex of a triangle list that is nearest to a point: a kd-tree.
class Nearest {
public:
    Nearest(const Mesh&, const Indices& to);
    struct Found {
        std::uint32_t vertex = 0;
        float distance2 = INFINITY;
    };
    Found find(glm::vec3 p) const {
        Found best;
        search(p, 0, points.size(), 0, best);
        return best;
    }

private:
    void build(std::size_t begin, std::size_t end, int axis);
    void search(glm::vec3 p, std::size_t begin, std::size_t end, int axis, Found& best) const;

    const Mesh* mesh;
    Indices points;
};

/// What a level looks like beside where it lies: how far its texture has slid, and how wrongly it
/// is lit and coloured, over how large a patch. As a distance [object units], so that it can be
/// allowed like an error of position: a texture that slid by a pixel is as visible as an edge that
/// did, and a patch a pixel wide is not seen however wrong.
class LooksError {
public:
    LooksError(const Mesh&, bool usesTextures);

    struct Found {
        float looks = 0;            ///< root of the mean square
        float offPlace = INFINITY;  ///< of any vertex; infinite unless all were looked at
    };
    Found of(const Indices& level, bool everyVertex) const;

private:
    struct Difference {
        float looks = INFINITY, place = INFINITY;
    };
    Difference differenceAt(const Vertex&, const std::vector<std::uint32_t>& triangles,
                            const Indices& level, float apart) const;

    const Mesh* mesh;
    bool textured;
    float density = 0;
};

}  // namespace lodestar::scene

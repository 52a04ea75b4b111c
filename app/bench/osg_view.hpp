// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <lodestar/quality/image.hpp>
#include <lodestar/scene/camera.hpp>
#include <lodestar/scene/mesh_lods.hpp>
#include <lodestar/shared/result.hpp>

namespace lodestar::app {

/// A scene in OpenSceneGraph, for comparison: one transform an instance in a tree of boxes, one
/// osg::LOD that switches at the distances at which lodestar does, one sun, vertex colours, no
/// textures. Draws into an off-screen OpenGL buffer.
class OsgView {
public:
    struct Settings {
        int width = 1280, height = 720;
        float errorPx = 1;  ///< of levels of detail; 0: the finest everywhere
    };
    /// Fails where there is no X display with OpenGL.
    static Result<OsgView> open(const scene::Scene&, const std::vector<scene::MeshLods>&,
                                const scene::Camera&, const Settings&);
    ~OsgView();
    OsgView(OsgView&&) noexcept;

    /// Culls and draws one frame and waits for it [ms, wall].
    double frame();
    /// Triangles the last frame handed to OpenGL.
    std::uint64_t triangles() const;
    /// What OpenGL calls its renderer.
    std::string renderer() const;
    quality::RgbImage picture() const;

private:
    struct Parts;
    explicit OsgView(std::unique_ptr<Parts>);
    std::unique_ptr<Parts> parts;
};

}  // namespace lodestar::app

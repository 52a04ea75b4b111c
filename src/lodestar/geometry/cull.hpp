// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <lodestar/geometry/hiz.hpp>
#include <lodestar/scene/gpu_scene.hpp>

namespace lodestar::geometry {

enum class CullMode {
    none,     ///< every triangle of every instance goes to the rasteriser
    frustum,  ///< instances and meshlets in view, not facing away; triangles that cover a pixel
    hiz,      ///< of these, what is not behind something
};

/// Which level of detail instances are drawn at.
struct LodChoice {
    enum class Mode { off, error, distance };
    Mode mode = Mode::off;
    float errorPx = 1;             ///< error: the coarsest level that is off by no more than this
    std::vector<float> distances;  ///< distance: where levels 1, 2, … begin [scene units]; ≤ 8
};

/// A picture whose samples will be captured in compute (visibility::CaptureCompute), or a band of
/// its rows.
struct SampledPicture {
    glm::mat4 clipFromWorld{1};
    vk::Extent2D size;  ///< samples of the whole picture
    std::uint32_t firstRow = 0, rows = 0;
    glm::vec2 textureScale{1};  ///< of the gradients of alpha tests
};

/// A view to cull for.
struct CullView {
    glm::mat4 clipFromWorld{1};  ///< reversed depth; orthographic or perspective
    glm::vec3 eye{0};            ///< world; used for normal cones, and for levels of detail
    vk::Extent2D size;           ///< of the target [pixels]
    /// Of the picture it becomes, in whose pixels errors and waves count; none: the target's.
    std::optional<vk::Extent2D> shown = {};
    bool perspective = true;
    bool keepBeforeNear = false;  ///< do not cull what lies before the near plane (shadow casters)
    CullMode cull = CullMode::frustum;  ///< hiz: by recordFirst() and recordSecond()
    LodChoice lod;
    /// Displaced meshes are refined where a wave of their relief is at least this many pixels long:
    /// Tessellate::record() for the view comes first. 0: not at all.
    float wavePx = 0;
    /// What the view shows, snapped to its samples: the listed clusters' vertices stay in the list,
    /// which was made with room for them.
    std::optional<SampledPicture> samples = {};
};

/// Pixels of the picture shown that a unit of length takes, a unit away.
float pixelsPerUnit(const CullView&);

/// Which of the draws of a list: those of its first phase, those of its second, or both.
enum class DrawPhase { both, first, second };

/// What lists for capture in compute have room for: 64 MiB of vertices.
inline constexpr std::uint32_t kProjectedClusters = 65536;

/// The triangles of one view, ready to draw: their ids in cluster order, and one
/// indirect draw a phase and bin. Deterministic: the same view gives the same bytes.
struct DrawList {
    /// A list of TablePart::whole names clusters by numbers that no view changes: what is to be
    /// kept. `projects`: how many clusters at most there is room to project the vertices of.
    DrawList(const gpu::Device&, const scene::GpuScene&, const std::string& name,
             scene::TablePart = scene::TablePart::eye, std::uint32_t projects = 0);

    gpu::TexelBuffer ids;  ///< cluster << 7 | meshlet triangle; clusters of GpuScene::clusters
    gpu::Buffer draws;     ///< vk::DrawIndirectCommand for each scene::DrawBin: those of the first
                           ///< phase, then those of the second
    gpu::Buffer counts;    ///< shared::CullCounts

    /// Of the first clusters, for CullView::samples: 64 places a cluster, one a vertex
    /// (project.glsl: packProjected), and what is z/w there.
    gpu::TexelBuffer projected, projectedDepths;
    std::uint32_t projectedClusters;        ///< at most
    std::optional<SampledPicture> samples;  ///< what they were projected for

    // What the passes hand on.
    gpu::Buffer params;                            ///< shared::CullParams
    gpu::Buffer chunkOffsets, chunks;              ///< visible chunks before each; the visible
    gpu::TexelBuffer firstOffsets, secondOffsets;  ///< meshlets before each place of an instance
    gpu::Buffer states;                            ///< of each: LS_STATE_*
    gpu::Buffer candidates, candidateOffsets, hidden;  ///< meshlets to look at; visible before each
    gpu::Buffer masks, triangleOffsets;                ///< of each visible cluster
    std::uint32_t chunkCount, instancePlaces, clusterPlaces, trianglePlaces;
    scene::TablePart part;  ///< of GpuScene::clusters that the ids name
    std::uint32_t table;    ///< where it begins
};

/// Culling and levels of detail on the GPU without read-back: chunks of instances, instances,
/// meshlets, then triangles. What is dropped could not have covered a sample.
class Cull {
public:
    explicit Cull(const gpu::Device&);

    /// Writes `list` and the scene's cluster table, visible to compute; the caller makes them
    /// visible to raster and indirect. Throws std::invalid_argument for a view without a size and
    /// for CullMode::hiz.
    void record(gpu::Recorder&, const scene::GpuScene&, const CullView&, DrawList& list) const;

    /// Occlusion in two phases: the first lists what `hiz`, the last picture, does not hide; the
    /// caller draws that, builds `hiz` of it, and the second lists what that does not hide of the
    /// rest. Whatever `hiz` held before, nothing visible is missing from the two.
    void recordFirst(gpu::Recorder&, const scene::GpuScene&, const CullView&, DrawList& list,
                     const HiZ& hiz) const;
    void recordSecond(gpu::Recorder&, const scene::GpuScene&, DrawList& list, const HiZ& hiz) const;

private:
    void start(gpu::Recorder&, const scene::GpuScene&, const CullView&, DrawList&,
               const HiZ*) const;
    void listClusters(gpu::Recorder&, const scene::GpuScene&, DrawList&, std::uint32_t phase,
                      const gpu::TexelBuffer& pyramid) const;
    void listTriangles(gpu::Recorder&, const scene::GpuScene&, DrawList&,
                       std::uint32_t phase) const;
    void scan(gpu::Recorder&, const gpu::Buffer& values, const DrawList&,
              const shared::ScanParams&) const;

    gpu::Kernel cullChunks, listChunks, cullInstances, cullClusters, compact, project,
        cullTriangles, cullProjected, emit;
    gpu::Kernel scanBlocks, scanTotals;
    gpu::TexelBuffer noPyramid;
};

}  // namespace lodestar::geometry

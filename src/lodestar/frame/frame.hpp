// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include <lodestar/budget/levers.hpp>
#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/frame/light_maps.hpp>
#include <lodestar/geometry/cull.hpp>
#include <lodestar/geometry/show_lods.hpp>
#include <lodestar/post/tonemap.hpp>
#include <lodestar/scene/camera.hpp>
#include <lodestar/shading/coarse.hpp>
#include <lodestar/shading/combine.hpp>
#include <lodestar/shading/sky.hpp>
#include <lodestar/upsample/pack_coarse.hpp>
#include <lodestar/upsample/upsample.hpp>
#include <lodestar/visibility/capture_ss.hpp>
#include <lodestar/visibility/expand.hpp>
#include <lodestar/visibility/fragments.hpp>
#include <lodestar/visibility/rebuild.hpp>
#include <lodestar/visibility/sample_grid.hpp>

namespace lodestar::frame {

/// What stays the same from frame to frame. What a budget may change is in budget::Levers.
struct FrameSettings {
    vk::Extent2D size{1280, 720};
    glm::vec3 toSun{0.5f, 0.8f, 0.35f};
    std::uint32_t shadowTaps = 9;        ///< N of the N×N PCF; 0 = no shadow
    std::uint32_t shadowMapSize = 2048;  ///< texels a side
    float shadowDistance = 0;            ///< how far shadows are drawn [scene units]; 0 = chosen
    std::uint32_t skyViews = 16;         ///< directions of ambient occlusion; 0 = none
    std::uint32_t skyTaps = 2;           ///< N of the N×N PCF of each
    std::uint32_t skyMapSize = 512;      ///< texels a side of each
    std::uint32_t noiseOctaves = 0;      ///< of the pattern on all surfaces; 0 = none, at most 12
    float noiseScale = 0;      ///< cells of its first octave [scene units]; 0 = 1/8 of the scene
    float leastWeight = 0.1f;  ///< pixels reconstructed from less may be repaired
    float exposure = 1;        ///< 0: metered on the first frame, and kept
    float aspect = 0;          ///< width / height that the picture shows; 0 = that of `size`
    upsample::Reconstruct reconstruct = upsample::Reconstruct::bilateral;
    upsample::Sigmas sigmas;
    geometry::CullMode cull = geometry::CullMode::frustum;
    geometry::LodChoice lod;
    bool showLods = false;  ///< colour the picture by level of detail
    /// s, 1, 2, 4 or 8: above 1 render() captures s² samples a pixel and blends what they show, the
    /// finest level of detail at full shading rate.
    std::uint32_t captureSide = 1;
    CaptureBackend capture = CaptureBackend::automatic;  ///< above 1
};

/// The whole frame: owns the targets, composes the passes.
class Frame {
public:
    /// Throws std::invalid_argument for settings out of range.
    Frame(const gpu::Device&, const scene::GpuScene&, const FrameSettings&);

    /// Renders one picture and waits for it. With several samples a pixel the levers have no say.
    gpu::FrameTimes render(const scene::Camera&, const budget::Levers&);
    /// What the last render() drew, seen from elsewhere at full quality: what its culling left out
    /// is missing, levels of detail are those it picked.
    gpu::FrameTimes renderOutside(const scene::Camera& outside);

    /// The same picture from visibility that was captured before, at any size: `record` is a
    /// capture of the same camera and aspect.
    gpu::FrameTimes rebuild(const visibility::CompactRecord&, const scene::Camera&,
                            const budget::Levers&);
    /// Anti-aliased, at the size of the record's grid B and at full shading rate: every surface a
    /// pixel lists weighs as many samples as show it, and is shaded once for all pixels around
    /// that show it too.
    gpu::FrameTimes rebuildAntialiased(const visibility::CompactRecord&, const scene::Camera&);
    /// Of the last rebuildAntialiased: fragments shaded beyond one a pixel.
    std::uint32_t furtherFragments() const { return smooth ? smooth->set.found().further : 0; }

    /// The last picture: RGBA8, sRGB-encoded.
    const gpu::Image& display() const { return displayImage; }
    const gpu::Image& radiance() const { return radianceImage; }
    /// Anti-aliased: those of the main fragments.
    const gpu::Image& ids() const { return samples && smooth ? smooth->set.ids : idImage; }
    const visibility::Surface& surface() const { return surfaces; }
    /// RGBA16_SFLOAT: share of the sun seen, share of the sky seen.
    const gpu::Image& terms() const { return termImage; }
    /// Pixels of the last frame whose coarse terms were evaluated anew. Waits for the device.
    std::uint32_t repairedPixels() const;
    const geometry::DrawList& drawList() const { return samples ? samples->drawList() : eyeList; }
    /// Forgets the last picture, which is otherwise used to guess what hides what.
    void resetOcclusion() { hiz.reset(); }
    /// As given; the exposure as in use.
    const FrameSettings& settings() const { return options; }

private:
    gpu::FrameTimes renderSamples(const scene::Camera&);
    void shade(const budget::Levers&);
    void evaluateTerms(const budget::Levers&);
    void shadeOnGridS(float rate);
    /// Sets the exposure by the last frame's radiance.
    void meter();
    glm::mat4 clipFromWorld(const scene::Camera&) const;

    /// What rebuilding from records of one rate needs.
    struct Rebuilding {
        std::uint32_t side;
        visibility::Expand expand;
    };
    /// What anti-aliasing needs beside it.
    struct Smooth {
        std::uint32_t side;
        visibility::Fragments fragments;
        visibility::FragmentSet set;
        visibility::Surface surfaces;  // of the further fragments
        gpu::Image terms, radiance, mainRadiance;
    };
    /// What shading as a whole on grid S needs.
    struct Whole {
        visibility::SampleGrid sampleGrid;
        visibility::Rebuild guides;  ///< depth and normal of O alone: no textures
        upsample::PackCoarse pack;
        gpu::Image ids, points, terms, radiance;
        visibility::Surface surfaces;
    };
    Whole makeWhole() const;
    Smooth makeSmooth(std::uint32_t side, std::uint32_t capacity) const;
    void writeUniforms(const scene::Camera&);
    void findVisible(const geometry::CullView&);

    const gpu::Device* device;
    const scene::GpuScene* scene;
    FrameSettings options;
    shading::Sky sky;
    std::array<glm::vec3, 9> irradiance;  ///< of the sky
    glm::vec3 sunIlluminance{0};
    float perLux = 1;  ///< units of the sky's light in a lux, candela, nit of the scene
    float aspect;

    geometry::Cull cull;
    geometry::ShowLods showLods;
    visibility::CaptureSs capture;
    visibility::Rebuild rebuildPass;
    shading::Coarse coarse;
    upsample::Upsample upsample;
    upsample::RepairSelect repairSelect;
    shading::Combine combine;
    post::Tonemap tonemap;

    geometry::DrawList eyeList;
    geometry::HiZ hiz;
    LightMaps lightMaps;
    upsample::RepairList repairList;
    bool listHolds = false;  ///< whether the last frame filled the list
    gpu::Buffer viewBuffer, lightBuffer;
    gpu::Image idImage, depthBuffer, skyImage, coarseImage, termImage, radianceImage, displayImage;
    visibility::Surface surfaces;

    std::optional<Rebuilding> rebuilding;
    std::optional<CaptureFrame> samples;  ///< where the settings ask for several a pixel
    std::optional<Smooth> smooth;
    std::optional<Whole> whole;
    gpu::Recorder rec;
};

}  // namespace lodestar::frame

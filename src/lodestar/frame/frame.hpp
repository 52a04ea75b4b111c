// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>

#include <lodestar/budget/levers.hpp>
#include <lodestar/frame/blended_layer.hpp>
#include <lodestar/frame/capture_frame.hpp>
#include <lodestar/frame/eye_capture.hpp>
#include <lodestar/frame/light_maps.hpp>
#include <lodestar/frame/motion_tracker.hpp>
#include <lodestar/frame/post_settings.hpp>
#include <lodestar/geometry/cull.hpp>
#include <lodestar/geometry/show_lods.hpp>
#include <lodestar/geometry/tessellate.hpp>
#include <lodestar/post/reduce.hpp>
#include <lodestar/post/tonemap.hpp>
#include <lodestar/scale/spatial.hpp>
#include <lodestar/scale/temporal.hpp>
#include <lodestar/scene/camera.hpp>
#include <lodestar/shading/background.hpp>
#include <lodestar/shading/coarse.hpp>
#include <lodestar/shading/combine.hpp>
#include <lodestar/shading/sky.hpp>
#include <lodestar/shading/weigh_repair.hpp>
#include <lodestar/upsample/pack_coarse.hpp>
#include <lodestar/upsample/refine.hpp>
#include <lodestar/upsample/repair.hpp>
#include <lodestar/upsample/upsample.hpp>
#include <lodestar/visibility/expand.hpp>
#include <lodestar/visibility/fragments.hpp>
#include <lodestar/visibility/list_tiles.hpp>
#include <lodestar/visibility/rebuild.hpp>
#include <lodestar/visibility/sample_grid.hpp>

namespace lodestar::frame {

class PostChain;
struct PostPicture;

/// What stays the same from frame to frame. What a budget may change is in budget::Levers.
struct FrameSettings {
    vk::Extent2D size{1280, 720};
    /// Largest Levers::renderScale of each axis: targets are made for it (or for 1) once, and
    /// smaller scales use a part of them. At most 2.
    budget::AxisScale maxScale = 1;
    scale::SpatialOptions scaling;  ///< how a frame of another scale becomes one of `size`
    glm::vec3 toSun{0.5f, 0.8f, 0.35f};
    std::uint32_t shadowTaps = 9;        ///< N of the N×N PCF; 0 = no shadow
    std::uint32_t shadowMapSize = 2048;  ///< texels a side
    float shadowDistance = 0;            ///< how far shadows are drawn [scene units]; 0 = chosen
    std::uint32_t skyViews = 16;         ///< directions of ambient occlusion; 0 = none
    std::uint32_t skyTaps = 2;           ///< N of the N×N PCF of each
    std::uint32_t skyMapSize = 512;      ///< texels a side of each
    std::uint32_t noiseOctaves = 0;      ///< of the pattern on all surfaces; 0 = none, at most 12
    std::uint32_t noiseWarps = 0;        ///< times the pattern warps its own domain, at most 8
    float noiseScale = 0;      ///< cells of its first octave [scene units]; 0 = 1/8 of the scene
    float leastWeight = 0.1f;  ///< pixels reconstructed from less may be repaired
    bool keepTerms = false;    ///< make Frame::terms() of every picture; temporal and SSAO do too
    bool motion = false;       ///< make motion vectors of every picture; temporal does so too
    PostSettings post;         ///< effects
    scale::TemporalOptions temporal;  ///< of render(): how the pictures of a sequence are joined
    /// sRGB-encoded colour, 0 … 1, behind everything in the place of the sky, which still lights
    /// and is mirrored; none: the sky.
    std::optional<glm::vec3> backdrop;
    float exposure = 1;  ///< 0: metered on the first frame, and kept
    float aspect = 0;    ///< width / height that the picture shows; 0 = that of `size`
    /// O is this many times `size` along an axis, 1 … 4, and filtered down. Rates of shading count
    /// from `size`: edges get all the samples, the expensive terms none extra. Levers::renderScale
    /// is 1 then.
    std::uint32_t supersample = 1;
    post::ReduceFilter reduce = post::ReduceFilter::box;
    upsample::Reconstruct reconstruct = upsample::Reconstruct::bilateral;
    upsample::Sigmas sigmas;
    upsample::Packing packing = upsample::Packing::full;
    geometry::CullMode cull = geometry::CullMode::frustum;
    geometry::LodChoice lod;
    float wavePx = 0;       ///< see geometry::CullView
    bool showLods = false;  ///< colour the picture by level of detail
    /// s, 1, 2, 4 or 8: above 1 render() captures s² samples a pixel and blends what they show, the
    /// finest level of detail at full shading rate.
    std::uint32_t captureSide = 1;
    CaptureBackend capture = CaptureBackend::automatic;  ///< multisample only above 1
};

/// The whole frame: owns the targets, composes the passes.
class Frame {
public:
    /// Throws std::invalid_argument for settings out of range.
    Frame(const gpu::Device&, const scene::GpuScene&, const FrameSettings&);

    ~Frame();

    /// Renders one picture and waits for it. With several samples a pixel the levers
    /// have no say but in the effects.
    gpu::FrameTimes render(const scene::Camera&, const budget::Levers&);
    /// What the last render() drew, seen from elsewhere at full quality: what its culling left out
    /// is missing, levels of detail are those it picked.
    gpu::FrameTimes renderOutside(const scene::Camera& outside);

    /// The same picture from visibility that was captured before, at any size: `record` is a
    /// capture of the same camera and aspect.
    gpu::FrameTimes rebuild(const visibility::CompactRecord&, const scene::Camera&,
                            const budget::Levers&);
    /// Anti-aliased, at the size of the record's grid B and at full shading rate (of the levers
    /// those of the effects count): every surface a
    /// pixel lists weighs as many samples as show it, and is shaded once for all pixels around
    /// that show it too.
    gpu::FrameTimes rebuildAntialiased(const visibility::CompactRecord&, const scene::Camera&,
                                       const budget::Levers& = {});
    /// Of the last rebuildAntialiased: fragments shaded beyond one a pixel.
    std::uint32_t furtherFragments() const { return smooth ? smooth->set.found().further : 0; }

    /// The last picture: RGBA8, sRGB-encoded.
    const gpu::Image& display() const { return displayImage; }
    /// Grid O of the last picture: Levers::renderScale · size. What follows has this extent.
    vk::Extent2D grid() const { return live; }
    /// The picture before it was scaled, RGBA8, its live part of the extent grid(); written only
    /// where that is not the size of the display.
    const gpu::Image& shown() const { return shownImage; }
    gpu::View radiance() const { return part(radianceImage, live); }
    /// Anti-aliased: those of the main fragments.
    gpu::View ids() const { return part(samples && smooth ? smooth->set.ids : idImage, live); }
    gpu::View depth() const { return part(surfaces.depth, live); }
    gpu::View normal() const { return part(surfaces.normal, live); }
    gpu::View material() const { return part(surfaces.material, live); }
    /// RGBA16_SFLOAT: share of the sun seen, share of the sky seen, pattern, share of the ambient
    /// light that the screen occludes. Only with FrameSettings::keepTerms; else it may be old.
    gpu::View terms() const { return part(termImage, live); }
    /// See visibility::Motion; only with FrameSettings::motion.
    gpu::View motion() const { return part(tracker.value().motion(), live); }
    /// Pixels of the last frame whose coarse terms were evaluated anew. Waits for the device.
    std::uint32_t repairedPixels() const;
    /// Texels of grid S that a local rate had evaluated beside every second one, in the last
    /// frame's last such grid. Waits for the device.
    std::uint32_t refinedTexels() const;
    /// See geometry::Tessellate::coarsenedBy(). Waits for the device.
    float refinementCoarsened() const;
    /// Blended surfaces of the last frame, one behind the other, that were shaded.
    std::uint32_t blendedFragments() const { return layer ? layer->fragmentCount() : 0; }
    /// N of the sun's filter from the next frame on, where there is a shadow: a change of load.
    /// Throws std::invalid_argument outside 1 … 128.
    void setShadowTaps(std::uint32_t taps);
    const geometry::DrawList& drawList() const { return samples ? samples->drawList() : eyeList; }
    /// Forgets the last picture, which is otherwise used to guess what hides what.
    void resetOcclusion() { hiz.reset(); }
    /// Forgets it for motion too: the camera was cut.
    void reset();
    /// As given, but `size` is that of grid O; the exposure as in use.
    const FrameSettings& settings() const { return options; }

private:
    Frame(const gpu::Device&, const scene::GpuScene&, const FrameSettings&, vk::Extent2D shown);
    /// Begins a picture: its grid O, light maps and uniforms.
    void begin(const scene::Camera&, const budget::Levers&, scale::TemporalMode);
    gpu::FrameTimes renderSamples(const scene::Camera&, const budget::Levers&);
    void shade(const budget::Levers&, const visibility::CompactRecord* from = nullptr);
    /// Blended surfaces over the radiance, where the scene has them.
    void blendLayer(float scale);
    /// Submits what is recorded of the picture; the times are those of all of it.
    gpu::FrameTimes finish();
    PostPicture picture(const visibility::CompactRecord* from) const;
    /// From radiance on grid O to the display.
    void show();
    bool termsAreConstant() const;
    bool keepsTerms() const;
    /// On grid O; or, where they are all on one grid S and nothing but shading wants them, that.
    std::optional<upsample::Upsample::Inputs> evaluateTerms(const budget::Levers&);
    void evaluateOnGridS(shading::Coarse::Mask, float rate, float localRate);
    void repairTerms(shading::Coarse::Mask missed, shading::Coarse::Mask evaluated, float share);
    void combineFromS(const upsample::Upsample::Inputs& termsOnS, float repair);
    shading::Coarse::Inputs termInputs() const;
    shading::Combine::Inputs combineInputs() const;
    void shadeOnGridS(float rate);
    void shadeBackground(bool writesTerms);
    /// Sets the exposure by the last frame's radiance.
    void meter();
    /// See geometry::CullView::shown.
    std::optional<vk::Extent2D> countedIn() const;
    glm::mat4 clipFromWorld(const scene::Camera&) const;
    glm::mat4 steadyClipFromWorld(const scene::Camera&) const;

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
    /// What supersampling needs.
    struct Reduction {
        post::Reduce pass;
        gpu::Image radiance;
    };
    Whole makeWhole() const;
    Smooth makeSmooth(std::uint32_t side, std::uint32_t capacity) const;
    void writeUniforms(const scene::Camera&);
    void findVisible(const geometry::CullView&);

    const gpu::Device* device;
    const scene::GpuScene* scene;
    FrameSettings options;
    vk::Extent2D room;    ///< of the targets
    vk::Extent2D live;    ///< the part of them that is grid O of this frame
    glm::vec2 jitter{0};  ///< of this frame [NDC]
    glm::vec2 textureScale{1};
    float focus = 1;  ///< distance of what the camera looks at
    shading::Sky sky;
    std::array<glm::vec3, 9> irradiance;  ///< of the sky
    glm::vec3 sunIlluminance{0};
    float perLux = 1;  ///< units of the sky's light in a lux, candela, nit of the scene
    float aspect;

    geometry::Tessellate tessellate;
    geometry::Cull cull;
    geometry::ShowLods showLods;
    EyeCapture capture;
    visibility::ListTiles listTiles;
    visibility::Rebuild rebuildPass;
    shading::Background background;
    shading::Coarse coarse;
    upsample::Upsample upsample;
    upsample::Refine refine;
    upsample::RepairSelect repairSelect;
    shading::WeighRepair weighRepair;
    shading::Combine combine;
    post::Tonemap tonemap;
    scale::Spatial spatial;

    geometry::DrawList eyeList;
    geometry::HiZ hiz;
    LightMaps lightMaps;
    gpu::TileList coveredTiles, emptyTiles;  ///< of grid O
    upsample::RepairList repairList;
    gpu::TexelList termTexels;  ///< of grid S: where the terms are evaluated
    bool listHolds = false;     ///< whether the last frame filled the list
    bool refines = false;       ///< whether it had a local rate
    gpu::Buffer viewBuffer, lightBuffer;
    gpu::Image idImage, skyImage, coarseImage, termImage, radianceImage, shownImage, displayImage;
    visibility::Surface surfaces;

    std::optional<BlendedLayer> layer;
    gpu::FrameTimes submitted;  ///< of this picture, before what is being recorded
    std::unique_ptr<PostChain> post;
    std::optional<MotionTracker> tracker;
    std::optional<scale::Temporal> temporal;
    scale::TemporalMode joining = scale::TemporalMode::off;  ///< of this frame
    std::uint32_t pictures = 0;
    std::optional<Rebuilding> rebuilding;
    std::optional<CaptureFrame> samples;  ///< where the settings ask for several a pixel
    std::optional<Smooth> smooth;
    std::optional<Whole> whole;
    std::optional<Reduction> reduction;
    gpu::Recorder rec;
};

}  // namespace lodestar::frame

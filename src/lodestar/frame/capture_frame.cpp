// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/capture_frame.hpp>

#include <algorithm>

#include <lodestar/gpu/readback.hpp>

namespace lodestar::frame {
namespace {

using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;
using visibility::Band;

const CaptureSettings& checked(const CaptureSettings& s) {
    if (s.side != 1 && s.side != 2 && s.side != 4 && s.side != 8)
        throw std::invalid_argument("CaptureSettings::side must be 1, 2, 4 or 8");
    if (s.base.width < 1 || s.base.height < 1 || s.base.width > 16384 / s.side ||
        s.base.height > 16384 / s.side)
        throw std::invalid_argument("CaptureSettings::base must be 1 … 16384 / side pixels a side");
    return s;
}

CaptureBackend usedBackend(const gpu::Device& device, const scene::GpuScene& scene,
                           const CaptureSettings& s) {
    if (s.backend == CaptureBackend::automatic)
        return chooseBackend(device, s, scene.triangleCount());
    // Rates that multisampling has no plan for are captured by supersampling.
    if (s.backend == CaptureBackend::multisample &&
        visibility::planMultisample(device.multisamples(), s.side).shifts.empty())
        return CaptureBackend::supersample;
    return s.backend;
}

/// Bytes that a row of grid B takes while its band is captured and compacted.
std::uint64_t rowBytes(CaptureBackend backend, const CaptureSettings& s) {
    const std::uint64_t samples = std::uint64_t{s.base.width} * s.side * s.side;
    const std::uint64_t counts = 5 * s.base.width;
    if (backend == CaptureBackend::multisample) return 12 * samples + counts;  // at most
    // In compute lists of tiles too: 8 bytes for 512 samples.
    return 8 * samples + samples / 64 + counts;
}

std::uint32_t chooseRows(const gpu::Device& device, CaptureBackend backend,
                         const CaptureSettings& s) {
    if (s.bandRows > 0) return std::min(s.bandRows, s.base.height);
    std::uint64_t room = s.transientBytes;
    if (backend == CaptureBackend::compute)
        room -= std::min(room, visibility::CaptureCompute::Scratch::fixedBytes());
    std::uint64_t rows = std::max<std::uint64_t>(room / rowBytes(backend, s), 1);
    if (backend == CaptureBackend::compute) {
        const auto& limits = device.physical().getProperties().limits;
        const std::uint64_t row = 8ull * s.base.width * s.side * s.side;
        rows = std::min<std::uint64_t>(rows, limits.maxStorageBufferRange / row);
        rows = std::min<std::uint64_t>(rows, limits.maxTexelBufferElements / (row / 8));
    }
    // A recorder takes 128 passes, a band is three.
    rows = std::max<std::uint64_t>(rows, (s.base.height + 39) / 40);
    // Bands of even height, so that none is a sliver.
    const auto bands = (s.base.height + rows - 1) / rows;
    return static_cast<std::uint32_t>((s.base.height + bands - 1) / bands);
}

std::uint32_t bandCount(std::uint32_t height, std::uint32_t rows) {
    return (height + rows - 1) / rows;
}

std::uint32_t firstPool(const CaptureSettings& s) {
    if (s.words > 0) return s.words;
    const std::uint64_t pixels = std::uint64_t{s.base.width} * s.base.height;
    return s.side == 1 ? 1 : static_cast<std::uint32_t>(std::max<std::uint64_t>(2 * pixels, 4096));
}

gpu::Image image(const gpu::Device& device, vk::Extent2D extent, vk::Format format,
                 vk::ImageUsageFlags usage, const char* name) {
    return {device, {.name = name, .format = format, .extent = extent, .usage = usage}};
}

}  // namespace

CaptureBackend chooseBackend(const gpu::Device& device, const CaptureSettings& s,
                             std::uint64_t listed) {
    constexpr std::uint64_t kSamplesOfSmall = 12;
    const std::uint64_t samples = std::uint64_t{s.base.width} * s.base.height * s.side * s.side;
    const bool small = listed * kSamplesOfSmall >= samples;
    const bool cpu = device.description().type == "Cpu";
    return (small || !cpu) && device.hasInt64Atomics() ? CaptureBackend::compute
                                                       : CaptureBackend::supersample;
}

CaptureBackend chooseBackend(const gpu::Device& device, const scene::GpuScene& scene,
                             const CaptureSettings& settings, const scene::Camera& camera) {
    const CaptureSettings& s = checked(settings);
    const geometry::Cull cull(device);
    geometry::DrawList list(device, scene, "choosing");
    const float aspect = static_cast<float>(s.base.width) / static_cast<float>(s.base.height);
    gpu::Recorder rec(device);
    rec.begin();
    cull.record(rec, scene,
                {.clipFromWorld = camera.clipFromView(aspect) * camera.viewFromWorld(),
                 .eye = camera.eye,
                 .size = {s.base.width * s.side, s.base.height * s.side},
                 .shown = s.base,
                 .lod = s.lod.value_or(geometry::LodChoice{})},
                list);
    rec.submit();
    const auto draws = gpu::as<vk::DrawIndirectCommand>(
        gpu::readBuffer(device, list.draws, scene::kDrawBins * sizeof(vk::DrawIndirectCommand)));
    std::uint64_t corners = 0;
    for (const auto& draw : draws) corners += draw.vertexCount;
    return chooseBackend(device, s, corners / 3);
}

CaptureFrame::CaptureFrame(const gpu::Device& owner, const scene::GpuScene& gpuScene,
                           const CaptureSettings& s)
    : device(&owner),
      scene(&gpuScene),
      settings(checked(s)),
      used(usedBackend(owner, gpuScene, s)),
      bandRows(chooseRows(owner, used, s)),
      cull(owner),
      draws(owner, gpuScene, "capture", s.lod ? scene::TablePart::eye : scene::TablePart::whole,
            used == CaptureBackend::compute ? geometry::kProjectedClusters : 0),
      working(makeWorking()),
      compactPass(owner, s.side),
      out(owner, s.base, s.side, firstPool(s), bandCount(s.base.height, bandRows)),
      rec(owner) {}

/// Bands are chosen by the bytes of their texels; what drivers align those to shows when they are
/// there, and takes rows off.
CaptureFrame::Working CaptureFrame::makeWorking() {
    for (;; bandRows -= std::max(bandRows / 16, 1u)) {
        const std::uint64_t before = device->allocatedBytes();
        Working made{makeBackend(), {*device, settings.base.width * bandRows}};
        transient = device->allocatedBytes() - before;
        if (transient <= settings.transientBytes || settings.bandRows > 0 || bandRows == 1)
            return made;
    }
}

CaptureFrame::Backend CaptureFrame::makeBackend() const {
    const auto& features = scene->features();
    const vk::Extent2D band{settings.base.width * settings.side, bandRows * settings.side};
    switch (used) {
        case CaptureBackend::multisample:
            return Multisample{{*device, features, settings.side},
                               {*device, settings.base.width, bandRows, settings.side}};
        case CaptureBackend::compute:
            return Compute{{*device, features}, {*device, std::uint64_t{band.width} * band.height}};
        default:
            return Supersample{
                {*device, features},
                image(*device, band, vk::Format::eR32Uint,
                      Usage::eColorAttachment | Usage::eSampled | Usage::eTransferSrc,
                      "capture: samples"),
                image(*device, band, vk::Format::eD32Sfloat, Usage::eDepthStencilAttachment,
                      "capture: depth")};
    }
}

vk::Extent2D CaptureFrame::gridC() const {
    return {settings.base.width * settings.side, settings.base.height * settings.side};
}

void CaptureFrame::record(gpu::Recorder& recorder, const scene::Camera& camera) {
    const float aspect =
        static_cast<float>(settings.base.width) / static_cast<float>(settings.base.height);
    const glm::mat4 clipFromWorld = camera.clipFromView(aspect) * camera.viewFromWorld();
    for (std::uint32_t i = 0; i < out.bands; ++i) {
        const std::uint32_t first = i * bandRows;
        recordBand(recorder, {i, first, std::min(bandRows, settings.base.height - first)},
                   clipFromWorld, camera.eye);
    }
}

geometry::SampledPicture CaptureFrame::pictureOf(const Band& band,
                                                 const glm::mat4& clipFromWorld) const {
    return {clipFromWorld, gridC(), band.firstRow * settings.side, band.rows * settings.side};
}

/// The triangles that a band may show, or, where levels of detail are chosen, the picture: what
/// stands for a mesh must be the same in all bands.
void CaptureFrame::listTriangles(gpu::Recorder& r, const Band& band, const glm::mat4& clipFromWorld,
                                 glm::vec3 eye) {
    if (settings.lod && band.index > 0) {
        r.barrier(Stage::compute, Stage::raster);  // what is drawn over has been compacted
        return;
    }
    if (band.index > 0) {  // the previous band's readers are done with the list
        r.barrier(Stage::raster, Stage::compute);
        r.barrier(Stage::compute, Stage::compute);
    }
    // Culling sees the band as a picture of its own; multisampling draws a pixel more around it.
    const std::uint32_t margin = used == CaptureBackend::multisample ? 1 : 0;
    const Band listed = settings.lod ? Band{0, 0, settings.base.height} : band;
    const auto height = static_cast<float>(settings.base.height);
    const auto rows = static_cast<float>(listed.rows + 2 * margin);
    const auto width = static_cast<float>(settings.base.width);
    const float widened = width + static_cast<float>(2 * margin);
    const float middle = static_cast<float>(2 * listed.firstRow + listed.rows) - height;
    glm::mat4 bandFromClip(1);
    bandFromClip[0][0] = width / widened;
    bandFromClip[1][1] = height / rows;
    bandFromClip[3][1] = -middle / rows;
    const vk::Extent2D shown{settings.base.width + 2 * margin, listed.rows + 2 * margin};
    geometry::CullView view{.clipFromWorld = bandFromClip * clipFromWorld,
                            .eye = eye,
                            .size = {shown.width * settings.side, shown.height * settings.side},
                            .shown = shown,
                            .lod = settings.lod.value_or(geometry::LodChoice{})};
    if (used == CaptureBackend::compute) view.samples = pictureOf(listed, clipFromWorld);
    cull.record(r, *scene, view, draws);
    r.barrier(Stage::compute, Stage::raster);
    r.barrier(Stage::compute, Stage::compute);
    r.barrier(Stage::compute, Stage::indirect);
}

void CaptureFrame::recordBand(gpu::Recorder& r, const Band& band, const glm::mat4& clipFromWorld,
                              glm::vec3 eye) {
    listTriangles(r, band, clipFromWorld, eye);
    visibility::Samples samples;
    if (auto* ss = std::get_if<Supersample>(&working.backend)) {
        const vk::Viewport whole{.y = -static_cast<float>(band.firstRow * settings.side),
                                 .width = static_cast<float>(gridC().width),
                                 .height = static_cast<float>(gridC().height),
                                 .maxDepth = 1};
        ss->pass.record(r, *scene, draws, clipFromWorld, {ss->ids, ss->depth, whole}, "capture");
        r.barrier(Stage::raster, Stage::compute);
        samples.ids = &ss->ids;
    } else if (auto* ms = std::get_if<Multisample>(&working.backend)) {
        ms->pass.record(r, *scene, draws, clipFromWorld, settings.base, band, ms->scratch);
        samples.ids = &ms->scratch.ids;
    } else {
        auto& compute = std::get<Compute>(working.backend);
        if (band.index > 0) r.barrier(Stage::compute, Stage::transfer);
        compute.pass.record(r, *scene, draws, pictureOf(band, clipFromWorld), compute.scratch,
                            "capture", geometry::DrawPhase::first);
        samples.pairs = &compute.scratch.pairs;
    }
    compactPass.record(r, samples, band, working.compact, out);
}

CaptureFrame::Done CaptureFrame::capture(const scene::Camera& camera) {
    Done done;
    for (;;) {
        rec.begin();
        record(rec, camera);
        done.times = rec.submit();
        if (!out.overflowed()) return done;
        done.recaptured = out.capacity;
        grow();
    }
}

void CaptureFrame::grow() {
    const std::uint64_t needed = out.wordsNeeded();
    const auto room = static_cast<std::uint32_t>(needed + needed / 4);
    out = visibility::CompactRecord(*device, settings.base, settings.side, room, out.bands);
}

}  // namespace lodestar::frame

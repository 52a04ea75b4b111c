// SPDX-License-Identifier: Apache-2.0
#include <lodestar/frame/eye_capture.hpp>

#include <stdexcept>

#include <lodestar/frame/targets.hpp>

namespace lodestar::frame {
namespace {

using gpu::Stage;

}  // namespace

EyeCapture::EyeCapture(const gpu::Device& device, const scene::GpuScene& scene, vk::Extent2D room,
                       CaptureBackend backend)
    : implementation(makeBackend(device, scene, room, backend)) {}

EyeCapture::Backend EyeCapture::makeBackend(const gpu::Device& device, const scene::GpuScene& scene,
                                            vk::Extent2D room, CaptureBackend backend) {
    if (backend == CaptureBackend::multisample)
        throw std::invalid_argument("FrameSettings::capture: at one sample a pixel ss or compute");
    if (backend == CaptureBackend::automatic)
        backend = visibility::CaptureCompute::fits(device, room) ? CaptureBackend::compute
                                                                 : CaptureBackend::supersample;
    if (backend == CaptureBackend::compute)
        return Compute{{device, scene.features()},
                       {device, std::uint64_t{room.width} * room.height}};
    return Raster{{device, scene.features()},
                  target(device, room, vk::Format::eD32Sfloat, "depth buffer",
                         vk::ImageUsageFlagBits::eDepthStencilAttachment)};
}

CaptureBackend EyeCapture::backend() const {
    return std::holds_alternative<Compute>(implementation) ? CaptureBackend::compute
                                                           : CaptureBackend::supersample;
}

std::optional<geometry::SampledPicture> EyeCapture::samplesOf(const glm::mat4& clipFromWorld,
                                                              vk::Extent2D size) const {
    if (!std::holds_alternative<Compute>(implementation)) return std::nullopt;
    return geometry::SampledPicture{clipFromWorld, size, 0, size.height};
}

void EyeCapture::record(gpu::Recorder& rec, const scene::GpuScene& scene,
                        const geometry::DrawList& list, const glm::mat4& clipFromWorld,
                        gpu::View ids, const std::string& name, geometry::DrawPhase phase,
                        glm::vec2 textureScale, bool complete) const {
    rec.barrier(Stage::compute, Stage::indirect);
    if (const auto* compute = std::get_if<Compute>(&implementation)) {
        rec.barrier(Stage::compute, Stage::compute);
        rec.barrier(Stage::compute, Stage::transfer);
        compute->pass.record(rec, scene, list,
                             {clipFromWorld, ids.extent, 0, ids.extent.height, textureScale},
                             compute->scratch, name, phase);
        if (complete) compute->pass.recordIds(rec, compute->scratch, ids);
        rec.barrier(Stage::compute, Stage::compute);
        return;
    }
    const auto& raster = std::get<Raster>(implementation);
    rec.barrier(Stage::compute, Stage::raster);
    raster.pass.record(rec, scene, list, clipFromWorld,
                       {ids, part(raster.depth, ids.extent), {}, textureScale}, name, phase);
    rec.barrier(Stage::raster, Stage::compute);
}

void EyeCapture::recordHiZ(gpu::Recorder& rec, vk::Extent2D size, const glm::mat4& clipFromWorld,
                           geometry::HiZ& hiz) const {
    if (const auto* compute = std::get_if<Compute>(&implementation))
        hiz.record(rec, compute->scratch.words, size, clipFromWorld);
    else
        hiz.record(rec, part(std::get<Raster>(implementation).depth, size), clipFromWorld);
}

}  // namespace lodestar::frame

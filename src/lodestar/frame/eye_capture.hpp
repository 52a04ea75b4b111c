// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <variant>

#include <lodestar/frame/capture_frame.hpp>

namespace lodestar::frame {

/// What the eye sees, at one sample a pixel of a picture that changes from frame to frame: ids, and
/// the depths that culling asks for what is hidden. By the raster pipeline or in compute.
class EyeCapture {
public:
    /// For pictures of up to `room`. Throws std::invalid_argument for CaptureBackend::multisample,
    /// gpu::DeviceError for compute on a device that cannot do it.
    EyeCapture(const gpu::Device&, const scene::GpuScene&, vk::Extent2D room, CaptureBackend);

    /// Draws `list`, whose contents compute has written, over what is there (the second phase) or
    /// anew, and leaves ids visible to compute: R32_UINT, color attachment and storage.
    /// `textureScale` is of the gradients of alpha tests. Where culling is not done yet, `complete`
    /// is false: the ids are not needed then.
    void record(gpu::Recorder&, const scene::GpuScene&, const geometry::DrawList& list,
                const glm::mat4& clipFromWorld, gpu::View ids, const std::string& name,
                geometry::DrawPhase, glm::vec2 textureScale, bool complete = true) const;
    /// The depths of a picture of `size` that was recorded last.
    void recordHiZ(gpu::Recorder&, vk::Extent2D size, const glm::mat4& clipFromWorld,
                   geometry::HiZ&) const;
    /// What automatic became.
    CaptureBackend backend() const;
    /// What culling must know of the picture: CullView::samples.
    std::optional<geometry::SampledPicture> samplesOf(const glm::mat4& clipFromWorld,
                                                      vk::Extent2D size) const;

private:
    struct Raster {
        visibility::CaptureSs pass;
        gpu::Image depth;
    };
    struct Compute {
        visibility::CaptureCompute pass;
        visibility::CaptureCompute::Scratch scratch;
    };
    using Backend = std::variant<Raster, Compute>;
    static Backend makeBackend(const gpu::Device&, const scene::GpuScene&, vk::Extent2D room,
                               CaptureBackend);
    Backend implementation;
};

}  // namespace lodestar::frame

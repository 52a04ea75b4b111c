// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/visibility/motion.hpp>

namespace lodestar::frame {

/// What a frame must remember of the one before to say how its pixels moved.
class MotionTracker {
public:
    /// `room` is the size of the largest grid O.
    MotionTracker(const gpu::Device&, const scene::GpuScene&, vk::Extent2D room);

    /// Writes the motion since the last call (none at the first, or after reset), and remembers
    /// this frame for the next. `clipFromWorld` is without jitter; `view` holds this frame's
    /// ViewParams. Leaves the motion visible to compute.
    void record(gpu::Recorder&, const scene::GpuScene&, gpu::View ids, const gpu::Buffer& view,
                const glm::mat4& clipFromWorld);
    /// Forgets the frame before: the camera was cut.
    void reset() { known = false; }

    /// Of the last record; see visibility::Motion.
    const gpu::Image& motion() const { return image; }
    /// Whether the last record moved anything: the camera, or an instance.
    bool moved() const { return anyMoved; }

private:
    visibility::Motion pass;
    gpu::Image image;
    gpu::TexelBuffer instances, vertices;  // a frame ago; vertices that deform
    glm::mat4 previousClip{1};
    std::uint64_t version = 0;  // of the instances
    bool known = false, anyMoved = false;
};

}  // namespace lodestar::frame

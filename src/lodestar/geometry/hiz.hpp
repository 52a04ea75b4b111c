// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/geometry/cull_params.h>
#include <lodestar/gpu/recorder.hpp>

namespace lodestar::geometry {

/// The farthest depth of every 2×2, 4×4, … pixels of a picture, and where it was seen from: what
/// may hide the next one. Reversed depth, so a texel is the least of those below it. Sizes are
/// rounded up, so any picture size is exact.
class HiZ {
public:
    HiZ(const gpu::Device&, vk::Extent2D size, const std::string& name);

    /// Builds it from a depth image (sampled) of any size, which a render scale may have made
    /// another than the picture's: the pyramid stays of the picture's, so that a change of scale
    /// loses nothing. Visible to compute; it is written by compute.
    void record(gpu::Recorder&, gpu::View depth, const glm::mat4& clipFromWorld);
    /// The same of a picture of `size` that was captured in compute: RG32_UINT words, row by row,
    /// the second the bits of the depth.
    void record(gpu::Recorder&, const gpu::TexelBuffer& words, vk::Extent2D size,
                const glm::mat4& clipFromWorld);
    /// Forgets the picture: nothing hides anything until the next record().
    void reset() { built = false; }

    bool valid() const { return built; }
    const glm::mat4& clipFromWorld() const { return seenFrom; }
    const gpu::TexelBuffer& pyramid() const { return texels; }

    struct Level {
        std::uint32_t width = 1, height = 1, offset = 0;
    };
    /// From LS_HIZ_FIRST to one texel.
    const std::vector<Level>& levels() const { return all; }
    vk::Extent2D size() const { return extent; }

private:
    /// The levels: the finest by `kernel` from what `picture` binds, the others from that.
    void recordLevels(gpu::Recorder&, const gpu::Kernel& kernel,
                      const std::vector<gpu::Binding>& picture, vk::Extent2D size,
                      const glm::mat4& clipFromWorld);

    vk::Extent2D extent;
    std::vector<Level> all;
    gpu::TexelBuffer texels;
    gpu::Kernel fromImage, fromWords, next;
    vk::raii::Sampler sampler;
    glm::mat4 seenFrom{1};
    bool built = false;
};

}  // namespace lodestar::geometry

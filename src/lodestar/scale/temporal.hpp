// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <lodestar/budget/levers.hpp>
#include <lodestar/gpu/recorder.hpp>

namespace lodestar::scale {

/// How pictures of a sequence are joined.
enum class TemporalMode {
    off,
    /// Binks 2011: odd and even frames moved half a texel, their sum weighted by velocity
    source,
    /// every frame moved by a longer sequence; the history follows exact motion and is kept where
    /// the same surface is seen
    lodestar,
};
inline constexpr std::array<std::string_view, 3> kTemporalNames{"off", "source", "lodestar"};

struct TemporalOptions {
    TemporalMode mode = TemporalMode::off;
    /// source: share of the frame before that a pixel of motion takes away; its K
    float k = 0.5f;
    // lodestar:
    float width = 0.35f;  ///< σ of the kernel that weighs samples [pixels of the output]
    /// most weight of the history, where a sample at a pixel's centre weighs 1: a quarter of it
    /// where a pixel travels, four times as much while nothing moves; 0: every frame stands alone
    float memory = 12;
    float sharpness = 0.1f;  ///< 0 = none
};

/// Where frame `index` has its samples, relative to the centres of texels [texels]: to be added to
/// the projection.
glm::vec2 jitterOf(TemporalMode, std::uint32_t index);
/// What texture gradients along x and y are multiplied by, so that detail is there for the frames
/// to gather: a LOD bias of −0.5 (source), or of log2 of the render scale, as of a picture of the
/// output's size.
glm::vec2 textureScaleOf(TemporalMode, budget::AxisScale scale);

/// Joins the pictures of a sequence, each of any scale, to pictures of one size. Owns the history,
/// which has the output's size, so it is kept when the scale changes.
class Temporal {
public:
    /// `room`: of the inputs. `size`: of the output. Throws std::invalid_argument for options out
    /// of range or a mode of off.
    Temporal(const gpu::Device&, vk::Extent2D room, vk::Extent2D size, const TemporalOptions&);

    struct Inputs {
        gpu::View color;     ///< RGBA8_UNORM, sampled, of the extent `room`: after tone mapping
        gpu::View motion;    ///< RGBA32_SFLOAT: visibility::Motion
        gpu::View depth;     ///< R32_SFLOAT: linear view depth, 0 = background
        gpu::View terms;     ///< RGBA16_SFLOAT, x: share of the sun seen
        gpu::View material;  ///< RGBA32_UINT: visibility::Surface
        /// R32_SFLOAT: how much of what a texel shows is of blended surfaces, whose motion is not
        /// known; none: there are none.
        const gpu::Image* layer = nullptr;
        vk::Extent2D live;    ///< the part of them in use
        glm::vec2 jitter{0};  ///< of this frame [texels]
        bool moved = true;    ///< the camera or an instance moved since the last record
    };
    /// Writes every texel of `output` (RGBA8_UNORM, storage, of the size given). Passes "temporal"
    /// and "sharpen".
    void record(gpu::Recorder&, const Inputs&, gpu::View output);
    /// Forgets the history: the camera was cut.
    void reset() { known = false; }

private:
    void recordSource(gpu::Recorder&, const Inputs&, gpu::View output);
    void recordOurs(gpu::Recorder&, const Inputs&, gpu::View output);

    TemporalOptions options;
    vk::Extent2D size;
    vk::raii::Sampler linearSampler, pointSampler;
    gpu::Kernel kernel;
    std::optional<gpu::Kernel> show;
    /// lodestar: what was joined, of the output's size, this frame's and the last one's. source:
    /// the last frame as it was, in the first of each.
    std::vector<gpu::Image> colors;  // RGBA16_SFLOAT (a: weight), or RGBA8_UNORM
    std::vector<gpu::Image> guides;  // RGBA32_SFLOAT: depth, instance, sun; or motion
    std::uint32_t newest = 0;
    bool known = false;
    vk::Extent2D liveBefore;
    glm::vec2 jitterBefore{0};
};

}  // namespace lodestar::scale

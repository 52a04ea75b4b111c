// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/shading/layer_params.h>
#include <lodestar/gpu/recorder.hpp>

namespace lodestar::shading {

/// Fragments of a blended layer, from what Peel found to the picture that they are blended over.
class Layer {
public:
    explicit Layer(const gpu::Device&);

    /// Fragments packed row after row, so that only those that there are get shaded.
    struct Fragments {
        Fragments(const gpu::Device&, std::uint32_t capacity);
        std::uint32_t capacity;
        gpu::Image ids, points;  ///< R32_UINT and RG32_SFLOAT: triangle and NDC
        gpu::Buffer count;       ///< mapped

        std::uint32_t found() const { return *count.mapped<std::uint32_t>(); }
        bool overflowed() const { return found() > capacity; }
        /// The rows that hold them; at least one.
        vk::Extent2D extent() const;
    };
    /// On the layer's grid.
    struct Targets {
        Targets(const gpu::Device&, vk::Extent2D room);
        gpu::Image slots;         ///< RGBA32_UINT: 1 + fragment, front to back
        gpu::Image guide;         ///< R32_SFLOAT: 1 / depth of what is opaque
        gpu::Image color, curve;  ///< RGBA16_SFLOAT, R32_SFLOAT
    };
    struct Peeled {
        std::vector<gpu::View> ids, alphas;  ///< visibility::Peel::Targets
        gpu::View opaqueDepth;               ///< grid O
        vk::Extent2D size;                   ///< of the layer's grid
    };
    /// Fills `fragments`: look at overflowed() once submitted. Pass "layer: list".
    void recordList(gpu::Recorder&, const Peeled&, const Fragments&, const Targets&) const;
    /// Blends the fragments, whose radiance this is, over one another and the layer over `radiance`
    /// (grid O, RGBA16_SFLOAT); `coverage` (R32_SFLOAT) says how much of that is the layer's.
    /// Pass "layer: blend".
    void recordBlend(gpu::Recorder&, const Peeled&, gpu::View fragmentRadiance, const Targets&,
                     gpu::View radiance, gpu::View coverage) const;

private:
    vk::raii::Sampler sampler;
    gpu::Kernel list, resolve, blend;
};

}  // namespace lodestar::shading

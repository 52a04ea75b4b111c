// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lodestar/frame/frame.hpp>
#include <lodestar/gpu/readback.hpp>
#include <lodestar/quality/image.hpp>

namespace lodestar::app {

/// Runs the filters over the last picture of a frame, each on its own.
class FilterRuns {
public:
    FilterRuns(const gpu::Device& owner, vk::Extent2D size)
        : device(&owner),
          pass(owner),
          output(owner, {.name = "scaled",
                         .format = vk::Format::eR8G8B8A8Unorm,
                         .extent = size,
                         .usage = vk::ImageUsageFlagBits::eStorage |
                                  vk::ImageUsageFlagBits::eTransferSrc}),
          rec(owner) {}

    double run(const frame::Frame& frame, const scale::SpatialOptions& options) {
        const bool native = frame.grid() == output.extent();
        rec.begin();
        pass.record(rec, native ? frame.display() : frame.shown(), frame.grid(), options, output);
        return rec.submit().passes.front().ms;
    }
    quality::RgbImage picture() const {
        const auto rgba = gpu::readImage(*device, output);
        quality::RgbImage image(static_cast<int>(output.extent().width),
                                static_cast<int>(output.extent().height));
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            image.rgb[i] = static_cast<std::uint8_t>(rgba[i / 3 * 4 + i % 3]);
        return image;
    }

private:
    const gpu::Device* device;
    scale::Spatial pass;
    gpu::Image output;
    gpu::Recorder rec;
};

}  // namespace lodestar::app

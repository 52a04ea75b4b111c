// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/background_params.h>
#include <lodestar/shading/background.hpp>
#include <lodestar/shading/sky_sampler.hpp>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/shading/background.comp.inc>
    ;

using gpu::Slot;

}  // namespace

Background::Background(const gpu::Device& device, bool backdrop)
    : skySampler(makeSkySampler(device)),
      kernel(device, "background", kCode,
             {Slot::uniformBuffer, Slot::uniformBuffer, Slot::sampledImage, Slot::storageImage,
              Slot::storageImage, Slot::storageImage, Slot::texelBuffer},
             sizeof(shared::BackgroundParams), {backdrop}) {}

void Background::record(gpu::Recorder& rec, const Inputs& in, const Outputs& out) const {
    const auto pass = rec.pass("background");
    const vk::Extent2D size = out.radiance.extent;
    rec.dispatchTiles(kernel, size, &in.tiles,
                      {in.view, in.light, {in.sky, skySampler}, out.depth, out.terms, out.radiance},
                      shared::BackgroundParams{.size = {size.width, size.height}});
}

}  // namespace lodestar::shading

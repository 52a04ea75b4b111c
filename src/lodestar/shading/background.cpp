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

gpu::Kernel makeKernel(const gpu::Device& device, bool backdrop, bool terms) {
    return {device,
            terms ? "background" : "background without terms",
            kCode,
            {Slot::uniformBuffer, Slot::uniformBuffer, Slot::sampledImage, Slot::storageImage,
             Slot::storageImage, Slot::storageImage, Slot::texelBuffer},
            sizeof(shared::BackgroundParams),
            {backdrop, terms}};
}

}  // namespace

Background::Background(const gpu::Device& device, bool backdrop)
    : skySampler(makeSkySampler(device)),
      kernel(makeKernel(device, backdrop, true)),
      withoutTerms(makeKernel(device, backdrop, false)) {}

void Background::record(gpu::Recorder& rec, const Inputs& in, const Outputs& out) const {
    const auto pass = rec.pass("background");
    const vk::Extent2D size = out.radiance.extent;
    // Without terms that binding is not written: any image of four halves does.
    rec.dispatchTiles(out.terms ? kernel : withoutTerms, size, &in.tiles,
                      {in.view,
                       in.light,
                       {in.sky, skySampler},
                       out.depth,
                       out.terms.value_or(out.radiance),
                       out.radiance},
                      shared::BackgroundParams{.size = {size.width, size.height}});
}

}  // namespace lodestar::shading

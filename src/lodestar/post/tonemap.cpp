// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/tonemap_params.h>
#include <lodestar/post/tonemap.hpp>

namespace lodestar::post {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/post/tonemap.comp.inc>
    ;

using gpu::Slot;

}  // namespace

Tonemap::Tonemap(const gpu::Device& device)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "tonemap", kCode, {Slot::sampledImage, Slot::storageImage},
             sizeof(shared::TonemapParams)) {}

void Tonemap::record(gpu::Recorder& rec, gpu::View radiance, float exposure,
                     gpu::View display) const {
    const auto pass = rec.pass("tonemap");
    rec.dispatch(kernel, gpu::groups8x8(display.extent), {{radiance, pointSampler}, display},
                 shared::TonemapParams{.exposure = exposure,
                                       .size = {display.extent.width, display.extent.height}});
}

}  // namespace lodestar::post

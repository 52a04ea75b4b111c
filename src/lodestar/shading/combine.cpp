// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/combine_params.h>
#include <lodestar/shading/combine.hpp>
#include <lodestar/shading/sky_sampler.hpp>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/shading/combine.comp.inc>
    ;

using gpu::Slot;

gpu::Kernel makeKernel(const gpu::Device& device, const scene::SceneFeatures& features, bool points,
                       bool backdrop) {
    return {device,
            points ? "combine at points" : "combine",
            kCode,
            {Slot::uniformBuffer, Slot::uniformBuffer, Slot::sampledImage, Slot::sampledImage,
             Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::storageBuffer,
             Slot::storageImage, Slot::sampledImage, Slot::texelBuffer},
            sizeof(shared::CombineParams),
            {features.emissive, features.unlit, features.punctualLights, points, backdrop}};
}

}  // namespace

Combine::Combine(const gpu::Device& device, const scene::SceneFeatures& features, bool backdrop)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      skySampler(makeSkySampler(device)),
      kernel(makeKernel(device, features, false, backdrop)),
      pointKernel(makeKernel(device, features, true, backdrop)) {}

void Combine::record(gpu::Recorder& rec, const Inputs& in, gpu::View radiance) const {
    const auto pass = rec.pass("combine");
    rec.dispatchTiles(in.points ? pointKernel : kernel, radiance.extent, in.tiles,
                      {in.view,
                       in.light,
                       {in.depth, pointSampler},
                       {in.material, pointSampler},
                       {in.emissive, pointSampler},
                       {in.terms, pointSampler},
                       {in.sky, skySampler},
                       in.lights,
                       radiance,
                       // Without points that binding is not read: any image of floats does.
                       {in.points ? *in.points : in.depth, pointSampler}},
                      shared::CombineParams{{radiance.extent.width, radiance.extent.height}});
}

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/combine_params.h>
#include <lodestar/shading/combine.hpp>
#include <lodestar/shading/sky_sampler.hpp>
#include <lodestar/upsample/reconstruct_params.hpp>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/shading/combine.comp.inc>
    ;

using gpu::Slot;

gpu::Kernel makeKernel(const gpu::Device& device, const char* name,
                       const scene::SceneFeatures& features, const CombineOptions& options,
                       bool points, bool onS) {
    return {
        device,
        name,
        kCode,
        {Slot::uniformBuffer, Slot::uniformBuffer, Slot::sampledImage, Slot::sampledImage,
         Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::storageBuffer,
         Slot::storageImage, Slot::sampledImage, Slot::sampledImage, Slot::sampledImage,
         Slot::texelBuffer},
        sizeof(shared::CombineParams),
        {features.emissive, features.unlit, features.punctualLights, points, options.backdrop, onS,
         upsample::domainOf(options.reconstruct), upsample::isGuided(options.reconstruct)}};
}

}  // namespace

Combine::Combine(const gpu::Device& device, const scene::SceneFeatures& features,
                 const CombineOptions& options)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      skySampler(makeSkySampler(device)),
      kernel(makeKernel(device, "combine", features, options, false, false)),
      pointKernel(makeKernel(device, "combine at points", features, options, true, false)),
      onS(makeKernel(device, "combine from grid S", features, options, false, true)) {}

void Combine::record(gpu::Recorder& rec, const Inputs& in, gpu::View radiance) const {
    if (in.points && in.termsOnS)
        throw std::invalid_argument("Combine: at points nothing is reconstructed");
    shared::CombineParams params{.size = {radiance.extent.width, radiance.extent.height}};
    if (in.termsOnS) params.from = upsample::reconstructParams(*in.termsOnS, in.sigmas);
    // What is bound in the place of images that are not read: any of the kind does.
    const gpu::View noFloats = in.depth, noWords = in.material;
    const auto pass = rec.pass("combine");
    rec.dispatchTiles(in.points     ? pointKernel
                      : in.termsOnS ? onS
                                    : kernel,
                      radiance.extent, in.tiles,
                      {in.view,
                       in.light,
                       {in.depth, pointSampler},
                       {in.material, pointSampler},
                       {in.emissive, pointSampler},
                       {in.terms, pointSampler},
                       {in.sky, skySampler},
                       in.lights,
                       radiance,
                       {in.points.value_or(noFloats), pointSampler},
                       {in.termsOnS ? in.termsOnS->coarse : noWords, pointSampler},
                       {in.termsOnS ? in.termsOnS->normal : noWords, pointSampler}},
                      params);
}

}  // namespace lodestar::shading

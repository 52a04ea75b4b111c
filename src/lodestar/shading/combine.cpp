// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/combine_params.h>
#include <lodestar/upsample/upsample_params.h>
#include <lodestar/shading/combine.hpp>
#include <lodestar/shading/sky_sampler.hpp>
#include <lodestar/upsample/reconstruct_params.hpp>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/shading/combine.comp.inc>
    ;
constexpr std::uint32_t kFromSCode[] =
#include <lodestar/shading/combine_from_s.comp.inc>
    ;
constexpr std::uint32_t kListedCode[] =
#include <lodestar/shading/combine_listed.comp.inc>
    ;

using gpu::Slot;

/// A kernel of combine.glsl: `slots` and `constants` follow those that all have.
template <typename Params>
gpu::Kernel makeKernel(const gpu::Device& device, const char* name,
                       std::span<const std::uint32_t> code, const scene::SceneFeatures& features,
                       const CombineOptions& options, const std::vector<gpu::SlotArray>& slots,
                       const std::vector<std::uint32_t>& constants = {}) {
    std::vector<gpu::SlotArray> allSlots{
        Slot::uniformBuffer, Slot::uniformBuffer, Slot::sampledImage,  Slot::sampledImage,
        Slot::sampledImage,  Slot::sampledImage,  Slot::storageBuffer, Slot::storageImage};
    allSlots.insert(allSlots.end(), slots.begin(), slots.end());
    std::vector<std::uint32_t> allConstants{features.emissive, features.unlit,
                                            features.punctualLights, options.backdrop};
    allConstants.insert(allConstants.end(), constants.begin(), constants.end());
    return {device, name, code, allSlots, sizeof(Params), allConstants};
}

gpu::Kernel makeOnO(const gpu::Device& device, const char* name,
                    const scene::SceneFeatures& features, const CombineOptions& options,
                    bool points) {
    return makeKernel<shared::CombineParams>(
        device, name, kCode, features, options,
        {Slot::sampledImage, Slot::sampledImage, Slot::texelBuffer}, {points});
}

gpu::Kernel makeFromS(const gpu::Device& device, const char* name,
                      const scene::SceneFeatures& features, const CombineOptions& options,
                      bool listing) {
    const upsample::Reconstruct kind = options.reconstruct;
    return makeKernel<shared::CombineFromSParams>(
        device, name, kFromSCode, features, options,
        {Slot::sampledImage, Slot::storageBuffer, Slot::storageBuffer, Slot::texelBuffer},
        {upsample::domainOf(kind), upsample::isGuided(kind),
         listing && upsample::isBilateral(kind)});
}

}  // namespace

Combine::Combine(const gpu::Device& device, const scene::SceneFeatures& features,
                 const CombineOptions& options)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      skySampler(makeSkySampler(device)),
      kernel(makeOnO(device, "combine", features, options, false)),
      atPoints(makeOnO(device, "combine at points", features, options, true)),
      fromS(makeFromS(device, "combine from grid S", features, options, false)),
      fromSWithList(makeFromS(device, "combine from grid S, listing", features, options, true)),
      repaired(makeKernel<shared::CombineParams>(
          device, "combine repaired", kListedCode, features, options,
          {Slot::sampledImage, Slot::storageBuffer, Slot::storageBuffer})),
      noList(device, "combine: no list", sizeof(shared::RepairHeader)) {}

std::vector<gpu::Binding> Combine::bindings(const Inputs& in, gpu::View radiance) const {
    return {in.view,
            in.light,
            {in.depth, pointSampler},
            {in.material, pointSampler},
            {in.emissive, pointSampler},
            {in.sky, skySampler},
            in.lights,
            radiance};
}

void Combine::record(gpu::Recorder& rec, const Inputs& in, gpu::View radiance) const {
    const auto pass = rec.pass("combine");
    std::vector<gpu::Binding> all = bindings(in, radiance);
    all.emplace_back(in.terms, pointSampler);
    // Without points that binding is not read: any image of floats does.
    all.emplace_back(in.points.value_or(in.depth), pointSampler);
    rec.dispatchTiles(in.points ? atPoints : kernel, radiance.extent, in.tiles, all,
                      shared::CombineParams{{radiance.extent.width, radiance.extent.height}});
}

void Combine::recordFromS(gpu::Recorder& rec, const Inputs& in,
                          const upsample::Upsample::Inputs& termsOnS,
                          const upsample::Sigmas& sigmas, const upsample::UpsampleOptions& options,
                          gpu::View radiance) const {
    const shared::CombineFromSParams params{
        .size = {radiance.extent.width, radiance.extent.height},
        .from = upsample::reconstructParams(termsOnS, sigmas, options)};
    const upsample::RepairList* list = options.repair;
    const auto pass = rec.pass("combine");
    std::vector<gpu::Binding> all = bindings(in, radiance);
    all.emplace_back(termsOnS.coarse, pointSampler);
    all.emplace_back(list ? list->header : noList);
    all.emplace_back(list ? list->listed : noList);
    rec.dispatchTiles(list ? fromSWithList : fromS, radiance.extent, in.tiles, all, params);
}

void Combine::recordRepaired(gpu::Recorder& rec, const Inputs& in, const upsample::RepairList& list,
                             gpu::View radiance) const {
    const auto pass = rec.pass("combine repaired");
    std::vector<gpu::Binding> all = bindings(in, radiance);
    all.emplace_back(in.terms, pointSampler);
    all.emplace_back(list.header);
    all.emplace_back(list.kept);
    rec.dispatchIndirect(repaired, list.header, all,
                         shared::CombineParams{{radiance.extent.width, radiance.extent.height}});
}

}  // namespace lodestar::shading

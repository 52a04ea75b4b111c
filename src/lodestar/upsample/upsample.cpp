// SPDX-License-Identifier: Apache-2.0
#include <lodestar/upsample/upsample_params.h>
#include <lodestar/upsample/reconstruct_params.hpp>
#include <lodestar/upsample/upsample.hpp>

namespace lodestar::upsample {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/upsample/upsample.comp.inc>
    ;

using gpu::Slot;

gpu::Kernel makeKernel(const gpu::Device& device, Reconstruct kind, bool guided, bool merge,
                       bool repair) {
    return {device,
            "upsample",
            kCode,
            {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::storageImage,
             Slot::storageBuffer, Slot::storageBuffer, Slot::texelBuffer},
            sizeof(shared::UpsampleParams),
            {domainOf(kind), guided && isGuided(kind), merge, repair && isBilateral(kind)}};
}

}  // namespace

Upsample::Upsample(const gpu::Device& device, Reconstruct kind)
    : reconstruct(kind),
      pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      guidedKernel(makeKernel(device, kind, true, false, false)),
      plain(makeKernel(device, kind, false, false, false)),
      guidedMerge(makeKernel(device, kind, true, true, false)),
      plainMerge(makeKernel(device, kind, false, true, false)),
      guidedRepair(makeKernel(device, kind, true, false, true)),
      guidedMergeRepair(makeKernel(device, kind, true, true, true)),
      noList(device, "upsample: no list", sizeof(shared::RepairHeader)) {}

bool Upsample::guided() const {
    return isGuided(reconstruct);
}

void Upsample::record(gpu::Recorder& rec, const Inputs& in, const Sigmas& sigmas, gpu::View terms,
                      const UpsampleOptions& options) const {
    const shared::UpsampleParams params{.from = reconstructParams(in, sigmas, options),
                                        .fullSize = {in.depth.extent.width, in.depth.extent.height},
                                        .terms = options.channels};
    const bool flat = params.from.depthFalloff == 0 && params.from.normalFalloff == 0;
    const auto pass = rec.pass("upsample");
    const bool merge = options.channels != 15;
    const bool listing = options.repair != nullptr;
    const gpu::Kernel& kernel = flat               ? (merge ? plainMerge : plain)
                                : merge && listing ? guidedMergeRepair
                                : listing          ? guidedRepair
                                : merge            ? guidedMerge
                                                   : guidedKernel;
    rec.dispatchTiles(kernel, in.depth.extent, in.tiles,
                      {{in.coarse, pointSampler},
                       {in.depth, pointSampler},
                       {in.normal, pointSampler},
                       terms,
                       listing ? options.repair->header : noList,
                       listing ? options.repair->listed : noList},
                      params);
}

}  // namespace lodestar::upsample

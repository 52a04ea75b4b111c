// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <lodestar/upsample/upsample_params.h>
#include <lodestar/upsample/falloff.hpp>
#include <lodestar/upsample/upsample.hpp>

namespace lodestar::upsample {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/upsample/upsample.comp.inc>
    ;

using gpu::Slot;

std::uint32_t domainOf(Reconstruct kind) {
    switch (kind) {
        case Reconstruct::nearest:
            return shared::LS_DOMAIN_NEAREST;
        case Reconstruct::bilateral:
        case Reconstruct::bilinear:
            return shared::LS_DOMAIN_TENT;
        case Reconstruct::biquadratic:
            return shared::LS_DOMAIN_QUADRATIC;
        case Reconstruct::bicubic:
            return shared::LS_DOMAIN_CUBIC;
        case Reconstruct::gaussian:
            return shared::LS_DOMAIN_GAUSSIAN;
        case Reconstruct::nearestDepth:
            return shared::LS_DOMAIN_NEAREST_DEPTH;
    }
    throw std::invalid_argument("Reconstruct");
}

bool isGuided(Reconstruct kind) {
    return kind != Reconstruct::bilinear && kind != Reconstruct::nearest;
}

/// Whether taps are weighted: only then can all of them be too light.
bool isBilateral(Reconstruct kind) {
    return isGuided(kind) && kind != Reconstruct::nearestDepth;
}

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
    if (!(in.rate >= 1)) throw std::invalid_argument("Upsample::Inputs::rate must be at least 1");
    if (in.size.width == 0 || in.size.height == 0 || in.size.width > in.coarse.extent.width ||
        in.size.height > in.coarse.extent.height)
        throw std::invalid_argument("Upsample::Inputs::size must be 1 … the size of coarse");
    if (!(options.leastWeight > 0 && options.leastWeight < 1))
        throw std::invalid_argument("UpsampleOptions::leastWeight must be between 0 and 1");
    if (options.repair && options.repair->size != in.depth.extent)
        throw std::invalid_argument("UpsampleOptions::repair: the list has another size");
    const shared::UpsampleParams params{.size = {in.size.width, in.size.height},
                                        .fullSize = {in.depth.extent.width, in.depth.extent.height},
                                        .inverseRate = 1 / in.rate,
                                        .depthFalloff = falloff(sigmas.z, "z"),
                                        .normalFalloff = falloff(sigmas.n, "n"),
                                        .terms = options.channels,
                                        .repairAbove = -std::log2(options.leastWeight),
                                        .repairSpread = options.mostSpread};
    const bool flat = params.depthFalloff == 0 && params.normalFalloff == 0;
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

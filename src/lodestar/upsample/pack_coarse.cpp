// SPDX-License-Identifier: Apache-2.0
#include <lodestar/upsample/pack_coarse.hpp>

namespace lodestar::upsample {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/upsample/pack_coarse.comp.inc>
    ;

using gpu::Slot;

}  // namespace

PackCoarse::PackCoarse(const gpu::Device& device, Packing packing)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "pack coarse", kCode,
             {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::storageImage}, 0,
             {packing == Packing::yang}) {}

void PackCoarse::record(gpu::Recorder& rec, const Inputs& in, gpu::View coarse) const {
    const auto pass = rec.pass("pack");
    rec.dispatch(
        kernel, gpu::groups8x8(in.terms.extent),
        {{in.terms, pointSampler}, {in.depth, pointSampler}, {in.normal, pointSampler}, coarse});
}

}  // namespace lodestar::upsample

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/shading/weigh_repair_params.h>
#include <lodestar/shading/weigh_repair.hpp>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kWorkgroups = 32;  // that walk the list

constexpr std::uint32_t kCode[] =
#include <lodestar/shading/weigh_repair.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

}  // namespace

WeighRepair::WeighRepair(const gpu::Device& device)
    : sampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "weigh repair", kCode,
             {Slot::uniformBuffer, Slot::uniformBuffer, Slot::sampledImage, Slot::storageBuffer,
              Slot::storageBuffer},
             sizeof(shared::WeighRepairParams)) {}

void WeighRepair::record(gpu::Recorder& rec, const Inputs& in, std::uint32_t terms,
                         const upsample::RepairList& list) const {
    const auto pass = rec.pass("weigh repair");
    const vk::Extent2D size = in.material.extent;
    rec.dispatch(kernel, {kWorkgroups, 1, 1},
                 {in.view, in.light, {in.material, sampler}, list.header, list.listed},
                 shared::WeighRepairParams{{size.width, size.height}, terms});
    rec.barrier(Stage::compute, Stage::compute);
}

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/reduce_params.h>
#include <lodestar/post/reduce.hpp>

namespace lodestar::post {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/post/reduce.comp.inc>
    ;

using gpu::Slot;

}  // namespace

Reduce::Reduce(const gpu::Device& device)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "reduce", kCode, {Slot::sampledImage, Slot::storageImage},
             sizeof(shared::ReduceParams)) {}

void Reduce::record(gpu::Recorder& rec, gpu::View large, ReduceFilter filter,
                    gpu::View small) const {
    const std::uint32_t factor = large.extent.width / small.extent.width;
    if (factor == 0 || large.extent.width != factor * small.extent.width ||
        large.extent.height != factor * small.extent.height)
        throw std::invalid_argument("Reduce: the pictures' sizes are no whole multiple");
    const auto pass = rec.pass("reduce");
    rec.dispatch(
        kernel, gpu::groups8x8(small.extent), {{large, pointSampler}, small},
        shared::ReduceParams{factor, filter == ReduceFilter::box ? shared::LS_REDUCE_BOX
                                                                 : shared::LS_REDUCE_MITCHELL});
}

}  // namespace lodestar::post

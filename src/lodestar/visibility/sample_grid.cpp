// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/sample_grid_params.h>
#include <lodestar/visibility/sample_grid.hpp>

namespace lodestar::visibility {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/visibility/sample_grid.comp.inc>
    ;

using gpu::Slot;

}  // namespace

SampleGrid::SampleGrid(const gpu::Device& device)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "sample grid", kCode,
             {Slot::sampledImage, Slot::storageImage, Slot::storageImage},
             sizeof(shared::SampleGridParams)) {}

void SampleGrid::record(gpu::Recorder& rec, gpu::View ids, float rate, const Outputs& out) const {
    if (!(rate >= 1)) throw std::invalid_argument("SampleGrid: the rate must be at least 1");
    const vk::Extent2D size = out.ids.extent;
    const auto pass = rec.pass("sample grid");
    rec.dispatch(kernel, gpu::groups8x8(size), {{ids, pointSampler}, out.ids, out.points},
                 shared::SampleGridParams{.size = {size.width, size.height},
                                          .fullSize = {ids.extent.width, ids.extent.height},
                                          .rate = rate});
}

}  // namespace lodestar::visibility

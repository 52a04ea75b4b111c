// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <lodestar/upsample/refine_params.h>
#include <lodestar/upsample/reconstruct_params.hpp>
#include <lodestar/upsample/refine.hpp>

namespace lodestar::upsample {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/upsample/refine.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

constexpr float kLeastWeight = 0.5f;  // g·g of each neighbour that a texel is filled in from

}  // namespace

Refine::Refine(const gpu::Device& device)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(device, "refine", kCode,
             {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::storageImage,
              Slot::storageBuffer, Slot::storageBuffer},
             sizeof(shared::RefineParams)) {}

void Refine::record(gpu::Recorder& rec, const Inputs& in, const Sigmas& sigmas, float spread,
                    gpu::View coarse, const gpu::TexelList& list) const {
    if (!(in.rate >= 1)) throw std::invalid_argument("Refine::Inputs::rate must be at least 1");
    if (!(spread > 0)) throw std::invalid_argument("Refine: spread must be above 0");
    if (in.size.width > list.size.width || in.size.height > list.size.height)
        throw std::invalid_argument("Refine: the grid is larger than the list's");
    const auto pass = rec.pass("refine");
    rec.barrier(Stage::compute, Stage::transfer);  // the list may be in use
    rec.barrier(Stage::indirect, Stage::transfer);
    rec.fill(list.header, 0);
    rec.barrier(Stage::transfer, Stage::compute);
    const vk::Extent2D cells{(in.size.width + 1) / 2, (in.size.height + 1) / 2};
    rec.dispatch(kernel, gpu::groups8x8(cells),
                 {{in.depth, pointSampler},
                  {in.normal, pointSampler},
                  {coarse, pointSampler},
                  coarse,
                  list.header,
                  list.texels},
                 shared::RefineParams{.size = {in.size.width, in.size.height},
                                      .rate = in.rate,
                                      .spread = spread,
                                      .depthFalloff = falloff(sigmas.z, "z"),
                                      .normalFalloff = falloff(sigmas.n, "n"),
                                      .unlike = -std::log2(kLeastWeight)});
    rec.barrier(Stage::compute, Stage::compute);
    rec.barrier(Stage::compute, Stage::indirect);
}

}  // namespace lodestar::upsample

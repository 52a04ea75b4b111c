// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scale/spatial_params.h>
#include <lodestar/gpu/linear_sampler.hpp>
#include <lodestar/scale/live_part.hpp>
#include <lodestar/scale/spatial.hpp>

namespace lodestar::scale {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/scale/spatial.comp.inc>
    ;

using gpu::Slot;

}  // namespace

Spatial::Spatial(const gpu::Device& device) : linearSampler(gpu::makeLinearSampler(device)) {
    for (std::uint32_t filter = 0; filter < kFilterNames.size(); ++filter)
        kernels.emplace_back(device, "scale, " + std::string(kFilterNames[filter]), kCode,
                             std::vector<gpu::SlotArray>{Slot::sampledImage, Slot::storageImage},
                             sizeof(shared::SpatialParams), gpu::Specialization{filter});
}

void Spatial::record(gpu::Recorder& rec, gpu::View source, vk::Extent2D live,
                     const SpatialOptions& options, gpu::View output) const {
    if (live.width == 0 || live.height == 0 || live.width > source.extent.width ||
        live.height > source.extent.height)
        throw std::invalid_argument("Spatial: live must be 1 … the size of the source");
    const auto share = [](float amount) { return amount >= 0 && amount <= 1; };
    if (!share(options.grain)) throw std::invalid_argument("SpatialOptions::grain must be 0 … 1");
    if (!share(options.offset)) throw std::invalid_argument("SpatialOptions::offset must be 0 … 1");

    Filter filter = options.filter;
    const bool shrinks = live.width >= output.extent.width && live.height >= output.extent.height;
    const bool smooths = filter == Filter::edgeAdaptive || filter == Filter::bicubic;
    if (smooths && (filter == Filter::edgeAdaptive ? shrinks : live == output.extent))
        filter = Filter::bilinear;

    const auto along = [](std::uint32_t n, std::uint32_t of) {
        return static_cast<float>(n) / static_cast<float>(of);
    };
    const vk::Extent2D whole = source.extent, out = output.extent;
    const shared::SpatialParams params{
        .step = {along(live.width, out.width), along(live.height, out.height)},
        .texelSize = {along(1, whole.width), along(1, whole.height)},
        .last = lastRead(live, whole),
        .live = {static_cast<float>(live.width), static_cast<float>(live.height)},
        .size = {out.width, out.height},
        .amount = filter == Filter::noise ? options.grain : options.offset,
        .seed = options.seed};
    const auto pass = rec.pass("scale");
    rec.dispatch(kernels[static_cast<std::size_t>(filter)], gpu::groups8x8(out),
                 {{source, linearSampler}, output}, params);
}

}  // namespace lodestar::scale

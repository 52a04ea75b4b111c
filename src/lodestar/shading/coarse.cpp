// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/shading/coarse.hpp>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/shading/coarse.comp.inc>
    ;

using gpu::Slot;

gpu::Kernel makeKernel(const gpu::Device& device, bool full, bool points) {
    return {device,
            full ? "terms" : "coarse terms",
            kCode,
            scene::withSceneSlots({Slot::uniformBuffer, Slot::uniformBuffer, Slot::sampledImage,
                                   Slot::sampledImage, Slot::storageImage, Slot::sampledImage}),
            sizeof(shared::CoarseParams),
            {full, points}};
}

}  // namespace

vk::Extent2D coarseExtent(vk::Extent2D full, float rate) {
    if (!(rate >= 1)) throw std::invalid_argument("shading rate must be at least 1");
    const auto along = [&](std::uint32_t n) {
        return static_cast<std::uint32_t>(std::ceil(static_cast<float>(n) / rate));
    };
    return {along(full.width), along(full.height)};
}

Coarse::Coarse(const gpu::Device& device)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      coarseKernel(makeKernel(device, false, false)),
      fullKernel(makeKernel(device, true, false)),
      pointKernel(makeKernel(device, true, true)) {}

void Coarse::record(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in, float rate,
                    gpu::View coarse) const {
    recordWith(rec, coarseKernel, scene, in, rate, coarse);
}

void Coarse::recordFull(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                        gpu::View terms) const {
    recordWith(rec, in.points ? pointKernel : fullKernel, scene, in, 1, terms);
}

void Coarse::recordWith(gpu::Recorder& rec, const gpu::Kernel& kernel, const scene::GpuScene& scene,
                        const Inputs& in, float rate, gpu::View out) const {
    const vk::Extent2D full = in.ids.extent;
    const vk::Extent2D size = coarseExtent(full, rate);
    const shared::CoarseParams params{
        .size = {size.width, size.height}, .fullSize = {full.width, full.height}, .rate = rate};
    const auto pass = rec.pass("terms");
    rec.dispatch(kernel, gpu::groups8x8(size),
                 scene::withScene(
                     scene, {in.view,
                             in.light,
                             {in.ids, pointSampler},
                             {in.shadowMap, pointSampler},
                             out,
                             // Without points that binding is not read: any image of floats does.
                             {in.points ? *in.points : in.shadowMap, pointSampler}}),
                 params);
}

}  // namespace lodestar::shading

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/post/ssao_params.h>
#include <lodestar/post/effective.hpp>
#include <lodestar/post/ssao.hpp>

namespace lodestar::post {
namespace {

constexpr std::uint32_t kGather[] =
#include <lodestar/post/ssao.comp.inc>
    ;
constexpr std::uint32_t kBlur[] =
#include <lodestar/post/ssao_blur.comp.inc>
    ;

using gpu::Slot;

}  // namespace

Ssao::Ssao(const gpu::Device& device)
    : pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      gather(device, "ssao", kGather,
             {Slot::uniformBuffer, Slot::sampledImage, Slot::sampledImage, Slot::storageImage},
             sizeof(shared::SsaoParams)),
      blur(device, "ssao blur", kBlur,
           {Slot::uniformBuffer, Slot::sampledImage, Slot::sampledImage, Slot::storageImage},
           sizeof(shared::SsaoParams)) {}

void Ssao::record(gpu::Recorder& rec, const Inputs& in, const SsaoOptions& o, gpu::View scratch,
                  gpu::View occlusion) const {
    require(o.radius > 0 && std::isfinite(o.radius), "SsaoOptions::radius must be > 0");
    require(o.strength >= 0 && std::isfinite(o.strength), "SsaoOptions::strength must be ≥ 0");
    require(o.bias >= 0 && o.bias < 1, "SsaoOptions::bias must be 0 … 1");
    require(o.samples >= 1 && o.samples <= 64, "SsaoOptions::samples must be 1 … 64");
    const shared::SsaoParams params{.grid = in.grid,
                                    .radius = o.radius,
                                    .bias = o.bias,
                                    .strength = o.strength,
                                    .samples = o.samples};
    const vk::Extent3D groups = gpu::groups8x8({in.grid.size.x, in.grid.size.y});
    const auto pass = rec.pass("ssao");
    rec.dispatch(gather, groups,
                 {in.view, {in.depth, pointSampler}, {in.normal, pointSampler}, scratch}, params);
    rec.barrier(gpu::Stage::compute, gpu::Stage::compute);
    rec.dispatch(blur, groups,
                 {in.view, {in.normal, pointSampler}, {scratch, pointSampler}, occlusion}, params);
}

}  // namespace lodestar::post

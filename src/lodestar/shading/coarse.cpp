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
constexpr std::uint32_t kRepairCode[] =
#include <lodestar/shading/repair_terms.comp.inc>
    ;

using gpu::Slot;

const std::vector<gpu::SlotArray> kInputSlots{Slot::uniformBuffer, Slot::uniformBuffer,
                                              Slot::sampledImage,  Slot::sampledImage,
                                              Slot::sampledImage,  Slot::storageImage};

gpu::Kernel makeKernel(const gpu::Device& device, const char* name, bool full, bool merge,
                       bool points) {
    auto slots = kInputSlots;
    slots.push_back(Slot::sampledImage);
    return {device,
            name,
            kCode,
            scene::withSceneSlots(slots),
            sizeof(shared::CoarseParams),
            {full, merge, points}};
}

gpu::Kernel makeRepair(const gpu::Device& device) {
    auto slots = kInputSlots;
    slots.insert(slots.end(), 2, Slot::storageBuffer);
    return {device, "repair terms", kRepairCode, scene::withSceneSlots(slots),
            sizeof(shared::CoarseParams)};
}

std::vector<gpu::Binding> bindings(const Coarse::Inputs& in, const vk::raii::Sampler& sampler,
                                   const gpu::View& out) {
    return {in.view, in.light, {in.ids, sampler}, {in.sunMap, sampler}, {in.skyMaps, sampler}, out};
}

std::vector<gpu::Binding> withPoints(const Coarse::Inputs& in, const vk::raii::Sampler& sampler,
                                     const gpu::View& out, const gpu::View& noPoints) {
    auto all = bindings(in, sampler, out);
    all.emplace_back(in.points ? *in.points : noPoints, sampler);
    return all;
}

shared::CoarseParams paramsOf(vk::Extent2D full, float rate, Coarse::Mask terms) {
    const vk::Extent2D size = coarseExtent(full, rate);
    return {.size = {size.width, size.height},
            .fullSize = {full.width, full.height},
            .rate = rate,
            .terms = terms};
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
      noPoints(device, {.name = "no points",
                        .format = vk::Format::eR32G32Sfloat,
                        .extent = {1, 1},
                        .usage = vk::ImageUsageFlagBits::eSampled}),
      coarse(makeKernel(device, "coarse terms", false, false, false)),
      full(makeKernel(device, "terms", true, false, false)),
      fullMerge(makeKernel(device, "some terms", true, true, false)),
      fullPoints(makeKernel(device, "terms at points", true, false, true)),
      repair(makeRepair(device)) {}

void Coarse::record(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in, Mask terms,
                    float rate, gpu::View out) const {
    const auto pass = rec.pass("terms");
    rec.dispatch(coarse, gpu::groups8x8(coarseExtent(in.ids.extent, rate)),
                 scene::withScene(scene, withPoints(in, pointSampler, out, noPoints)),
                 paramsOf(in.ids.extent, rate, terms));
}

void Coarse::recordFull(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                        Mask terms, gpu::View out) const {
    const auto pass = rec.pass("terms");
    if (in.points && terms != shared::LS_ALL_TERMS)
        throw std::invalid_argument("Coarse::recordFull: at points all terms are evaluated");
    const gpu::Kernel& kernel = in.points                       ? fullPoints
                                : terms == shared::LS_ALL_TERMS ? full
                                                                : fullMerge;
    rec.dispatch(kernel, gpu::groups8x8(in.ids.extent),
                 scene::withScene(scene, withPoints(in, pointSampler, out, noPoints)),
                 paramsOf(in.ids.extent, 1, terms));
}

void Coarse::recordRepair(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                          Mask terms, const upsample::RepairList& list, gpu::View out) const {
    const auto pass = rec.pass("repair");
    auto all = bindings(in, pointSampler, out);
    all.insert(all.end(), {list.header, list.kept});
    rec.dispatchIndirect(repair, list.header, scene::withScene(scene, all),
                         paramsOf(in.ids.extent, 1, terms));
}

}  // namespace lodestar::shading

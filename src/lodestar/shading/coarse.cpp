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
constexpr std::uint32_t kListedCode[] =
#include <lodestar/shading/coarse_listed.comp.inc>
    ;

using gpu::Slot;

const std::vector<gpu::SlotArray> kInputSlots{Slot::uniformBuffer, Slot::uniformBuffer,
                                              Slot::sampledImage,  Slot::sampledImage,
                                              Slot::sampledImage,  Slot::storageImage};

gpu::Kernel makeKernel(const gpu::Device& device, const char* name, bool full, bool merge,
                       bool points) {
    auto slots = kInputSlots;
    slots.insert(slots.end(), {Slot::sampledImage, Slot::texelBuffer});
    return {device,
            name,
            kCode,
            scene::withSceneSlots(slots),
            sizeof(shared::CoarseParams),
            {full, merge, points}};
}

gpu::Kernel makeListed(const gpu::Device& device, const char* name,
                       std::span<const std::uint32_t> code) {
    auto slots = kInputSlots;
    slots.insert(slots.end(), 2, Slot::storageBuffer);
    return {device, name, code, scene::withSceneSlots(slots), sizeof(shared::CoarseParams)};
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

shared::CoarseParams paramsOf(const Coarse::Inputs& in, float rate, Coarse::Mask terms,
                              std::uint32_t step = 1) {
    const vk::Extent2D full = in.ids.extent, size = coarseExtent(full, rate);
    return {.size = {size.width, size.height},
            .fullSize = {full.width, full.height},
            .rate = rate,
            .terms = terms,
            .yang = in.packing == upsample::Packing::yang,
            .step = step};
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
      repair(makeListed(device, "repair terms", kRepairCode)),
      listed(makeListed(device, "listed terms", kListedCode)) {}

void Coarse::record(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in, Mask terms,
                    float rate, gpu::View out, std::uint32_t step) const {
    const auto pass = rec.pass("terms");
    const vk::Extent2D size = coarseExtent(in.ids.extent, rate);
    rec.dispatchTiles(coarse, {gpu::groups(size.width, step), gpu::groups(size.height, step)},
                      nullptr, scene::withScene(scene, withPoints(in, pointSampler, out, noPoints)),
                      paramsOf(in, rate, terms, step));
}

void Coarse::recordListed(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                          Mask terms, float rate, const upsample::RefineList& list,
                          gpu::View out) const {
    const auto pass = rec.pass("terms");
    auto all = bindings(in, pointSampler, out);
    all.insert(all.end(), {list.header, list.listed});
    rec.dispatchIndirect(listed, list.header, scene::withScene(scene, all),
                         paramsOf(in, rate, terms));
}

void Coarse::recordFull(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                        Mask terms, gpu::View out) const {
    const auto pass = rec.pass("terms");
    if (in.points && terms != shared::LS_ALL_TERMS)
        throw std::invalid_argument("Coarse::recordFull: at points all terms are evaluated");
    const gpu::Kernel& kernel = in.points                       ? fullPoints
                                : terms == shared::LS_ALL_TERMS ? full
                                                                : fullMerge;
    rec.dispatchTiles(kernel, in.ids.extent, in.tiles,
                      scene::withScene(scene, withPoints(in, pointSampler, out, noPoints)),
                      paramsOf(in, 1, terms));
}

void Coarse::recordRepair(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                          Mask terms, const upsample::RepairList& list, gpu::View out) const {
    const auto pass = rec.pass("repair");
    auto all = bindings(in, pointSampler, out);
    all.insert(all.end(), {list.header, list.kept});
    rec.dispatchIndirect(repair, list.header, scene::withScene(scene, all), paramsOf(in, 1, terms));
}

}  // namespace lodestar::shading

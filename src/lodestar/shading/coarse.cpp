// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <lodestar/shading/coarse_params.h>
#include <lodestar/scene/scene_bindings.hpp>
#include <lodestar/shading/coarse.hpp>

namespace lodestar::shading {
namespace {

constexpr std::uint32_t kTermsCode[] =
#include <lodestar/shading/terms.comp.inc>
    ;
constexpr std::uint32_t kListCode[] =
#include <lodestar/shading/coarse_list.comp.inc>
    ;
constexpr std::uint32_t kCoarseCode[] =
#include <lodestar/shading/coarse.comp.inc>
    ;
constexpr std::uint32_t kRepairCode[] =
#include <lodestar/shading/repair_terms.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;

const std::vector<gpu::SlotArray> kInputSlots{Slot::uniformBuffer, Slot::uniformBuffer,
                                              Slot::sampledImage,  Slot::sampledImage,
                                              Slot::sampledImage,  Slot::storageImage};

gpu::Kernel makeFull(const gpu::Device& device, const char* name, Coarse::Mask present, bool merge,
                     bool points) {
    auto slots = kInputSlots;
    slots.insert(slots.end(), {Slot::sampledImage, Slot::texelBuffer});
    return {device,
            name,
            kTermsCode,
            scene::withSceneSlots(slots),
            sizeof(shared::CoarseParams),
            {merge, points, present}};
}

gpu::Kernel makeListed(const gpu::Device& device, const char* name, Coarse::Mask present,
                       std::span<const std::uint32_t> code) {
    auto slots = kInputSlots;
    slots.insert(slots.end(), 2, Slot::storageBuffer);
    return {device,         name, code, scene::withSceneSlots(slots), sizeof(shared::CoarseParams),
            {0, 0, present}};
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

Coarse::Coarse(const gpu::Device& device, Mask present)
    : terms(present),
      pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      noPoints(device, {.name = "no points",
                        .format = vk::Format::eR32G32Sfloat,
                        .extent = {1, 1},
                        .usage = vk::ImageUsageFlagBits::eSampled}),
      full(makeFull(device, "terms", present, false, false)),
      fullMerge(makeFull(device, "some terms", present, true, false)),
      fullPoints(makeFull(device, "terms at points", present, false, true)),
      repair(makeListed(device, "repair terms", present, kRepairCode)),
      list(device, "list coarse terms", kListCode,
           {Slot::sampledImage, Slot::storageImage, Slot::storageBuffer, Slot::storageBuffer},
           sizeof(shared::CoarseParams)),
      coarse(makeListed(device, "coarse terms", present, kCoarseCode)) {}

void Coarse::record(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in, Mask terms,
                    float rate, const gpu::TexelList& covered, gpu::View out,
                    std::uint32_t step) const {
    const vk::Extent2D size = coarseExtent(in.ids.extent, rate);
    if (size.width > covered.size.width || size.height > covered.size.height)
        throw std::invalid_argument("Coarse: the grid is larger than the list's");
    {
        const auto pass = rec.pass("list terms");
        rec.barrier(Stage::compute, Stage::transfer);  // the list may be in use for another rate
        rec.barrier(Stage::indirect, Stage::transfer);
        rec.fill(covered.header, 0);
        rec.barrier(Stage::transfer, Stage::compute);
        rec.dispatch(
            list, gpu::groups8x8({gpu::groups(size.width, step), gpu::groups(size.height, step)}),
            {{in.ids, pointSampler}, out, covered.header, covered.texels},
            paramsOf(in, rate, terms, step));
        rec.barrier(Stage::compute, Stage::compute);
        rec.barrier(Stage::compute, Stage::indirect);
    }
    recordListed(rec, scene, in, terms, rate, covered, out);
}

void Coarse::recordListed(gpu::Recorder& rec, const scene::GpuScene& scene, const Inputs& in,
                          Mask terms, float rate, const gpu::TexelList& listed,
                          gpu::View out) const {
    const auto pass = rec.pass("terms");
    auto all = bindings(in, pointSampler, out);
    all.insert(all.end(), {listed.header, listed.texels});
    rec.dispatchIndirect(coarse, listed.header, scene::withScene(scene, all),
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

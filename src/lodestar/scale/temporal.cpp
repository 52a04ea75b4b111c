// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include <lodestar/scale/temporal_params.h>
#include <lodestar/gpu/linear_sampler.hpp>
#include <lodestar/scale/live_part.hpp>
#include <lodestar/scale/temporal.hpp>

namespace lodestar::scale {
namespace {

constexpr std::uint32_t kCode[] =
#include <lodestar/scale/temporal.comp.inc>
    ;
constexpr std::uint32_t kSourceCode[] =
#include <lodestar/scale/temporal_source.comp.inc>
    ;
constexpr std::uint32_t kShowCode[] =
#include <lodestar/scale/temporal_show.comp.inc>
    ;

using gpu::Slot;
using gpu::Stage;
using Usage = vk::ImageUsageFlagBits;

/// What stands still leaves no ghost, however long it is remembered.
constexpr float kStillMemory = 4;

TemporalOptions checked(const TemporalOptions& o) {
    const auto within = [](float value, float most) { return value >= 0 && value <= most; };
    if (o.mode == TemporalMode::off)
        throw std::invalid_argument("TemporalOptions::mode must not be off");
    if (!within(o.k, 1e6f)) throw std::invalid_argument("TemporalOptions::k must be ≥ 0");
    if (!(o.width > 0.05f && o.width <= 4))
        throw std::invalid_argument("TemporalOptions::width must be 0.05 … 4");
    if (!within(o.memory, 1000))
        throw std::invalid_argument("TemporalOptions::memory must be 0 … 1000");
    if (!within(o.sharpness, 1))
        throw std::invalid_argument("TemporalOptions::sharpness must be 0 … 1");
    return o;
}

bool isSource(const TemporalOptions& o) {
    return o.mode == TemporalMode::source;
}

gpu::Kernel makeKernel(const gpu::Device& device, const TemporalOptions& o) {
    if (isSource(o))
        return {device,
                "temporal, source",
                kSourceCode,
                {Slot::sampledImage, Slot::sampledImage, Slot::sampledImage, Slot::sampledImage,
                 Slot::storageImage, Slot::sampledImage, Slot::sampledImage},
                sizeof(shared::TemporalSourceParams)};
    std::vector<gpu::SlotArray> slots(7, Slot::sampledImage);
    slots.insert(slots.end(), 2, Slot::storageImage);
    slots.push_back(Slot::sampledImage);
    return {device, "temporal", kCode, slots, sizeof(shared::TemporalParams)};
}

std::vector<gpu::Image> images(const gpu::Device& device, std::size_t count, const char* name,
                               vk::Format format, vk::Extent2D extent) {
    std::vector<gpu::Image> made;
    for (std::size_t i = 0; i < count; ++i)
        made.emplace_back(device,
                          gpu::ImageInfo{.name = name,
                                         .format = format,
                                         .extent = extent,
                                         .usage = Usage::eSampled | Usage::eStorage |
                                                  Usage::eTransferDst | Usage::eTransferSrc});
    return made;
}

void copyPart(gpu::Recorder& rec, gpu::View from, gpu::View to, vk::Extent2D extent) {
    const vk::ImageSubresourceLayers layer{.aspectMask = vk::ImageAspectFlagBits::eColor,
                                           .layerCount = 1};
    const vk::ImageCopy region{.srcSubresource = layer,
                               .dstSubresource = layer,
                               .extent = {extent.width, extent.height, 1}};
    rec.vk().copyImage(from.image, vk::ImageLayout::eGeneral, to.image, vk::ImageLayout::eGeneral,
                       region);
}

glm::vec2 vec(vk::Extent2D extent) {
    return {extent.width, extent.height};
}

}  // namespace

glm::vec2 jitterOf(TemporalMode mode, std::uint32_t index) {
    if (mode == TemporalMode::off) return glm::vec2(0);
    if (mode == TemporalMode::source) return glm::vec2(index % 2 == 0 ? 0.25f : -0.25f);
    // Multiples of two numbers whose fractions are even over any run of frames, the longer the
    // finer, and over every second to fifth of them, should S change in turn: of 200 pairs those
    // that were least off the areas of half planes. They do not come round: a cycle would find the
    // same edges off for ever. As fractions of 2³² the products wrap where fractions do.
    const auto part = [index](std::uint32_t step) {
        return static_cast<float>((index * step) >> 8) / 16777216.0f - 0.5f;
    };
    return {part(3064188577u), part(3500413139u)};
}

glm::vec2 textureScaleOf(TemporalMode mode, budget::AxisScale scale) {
    if (mode == TemporalMode::off) return glm::vec2(1);
    if (mode == TemporalMode::source) return glm::vec2(std::exp2(-0.5f));
    const budget::AxisScale bias = scale.atMost(1);
    return {bias.x, bias.y};
}

Temporal::Temporal(const gpu::Device& device, vk::Extent2D room, vk::Extent2D outSize,
                   const TemporalOptions& o)
    : options(checked(o)),
      size(outSize),
      linearSampler(gpu::makeLinearSampler(device)),
      pointSampler(device.vk(), vk::SamplerCreateInfo{}),
      kernel(makeKernel(device, o)),
      colors(isSource(o) ? images(device, 1, "frame before", vk::Format::eR8G8B8A8Unorm, room)
                         : images(device, 2, "history", vk::Format::eR16G16B16A16Sfloat, outSize)),
      guides(isSource(o)
                 ? images(device, 1, "motion before", vk::Format::eR32G32B32A32Sfloat, room)
                 : images(device, 2, "history guide", vk::Format::eR32G32B32A32Sfloat, outSize)) {
    if (isSource(o))
        guides.push_back(
            std::move(images(device, 1, "layer before", vk::Format::eR32Sfloat, room).front()));
    if (!isSource(o))
        show.emplace(device, "sharpen", kShowCode,
                     std::vector<gpu::SlotArray>{Slot::sampledImage, Slot::storageImage},
                     sizeof(shared::TemporalShowParams));
}

void Temporal::record(gpu::Recorder& rec, const Inputs& in, gpu::View output) {
    if (output.extent != size) throw std::invalid_argument("Temporal: the output has another size");
    if (in.live.width == 0 || in.live.height == 0 || in.live.width > in.color.extent.width ||
        in.live.height > in.color.extent.height)
        throw std::invalid_argument("Temporal: live must be 1 … the size of the inputs");
    isSource(options) ? recordSource(rec, in, output) : recordOurs(rec, in, output);
    known = true;
    liveBefore = in.live;
    jitterBefore = in.jitter;
}

void Temporal::recordSource(gpu::Recorder& rec, const Inputs& in, gpu::View output) {
    const vk::Extent2D room = in.color.extent, before = known ? liveBefore : in.live;
    const auto pass = rec.pass("temporal");
    rec.dispatch(kernel, gpu::groups8x8(size),
                 {{in.color, linearSampler},
                  {colors[0], linearSampler},
                  {in.motion, pointSampler},
                  {guides[0], pointSampler},
                  output,
                  {in.layer ? in.layer->view() : in.motion, pointSampler},
                  {guides[1], pointSampler}},
                 shared::TemporalSourceParams{.texelSize = 1.0f / vec(room),
                                              .last = lastRead(in.live, room),
                                              .live = vec(in.live),
                                              .jitter = in.jitter,
                                              .lastBefore = lastRead(before, room),
                                              .liveBefore = vec(before),
                                              .jitterBefore = jitterBefore,
                                              .size = {size.width, size.height},
                                              .k = options.k,
                                              .known = known,
                                              .layered = in.layer && in.moved});
    rec.barrier(Stage::compute, Stage::transfer);
    copyPart(rec, in.color, colors[0], in.live);
    copyPart(rec, in.motion, guides[0], in.live);
    if (in.layer) copyPart(rec, *in.layer, guides[1], in.live);
    rec.barrier(Stage::transfer, Stage::compute);
}

void Temporal::recordOurs(gpu::Recorder& rec, const Inputs& in, gpu::View output) {
    const std::uint32_t older = newest;
    newest = 1 - newest;
    {
        const auto pass = rec.pass("temporal");
        rec.dispatch(
            kernel, gpu::groups8x8(size),
            {{in.color, linearSampler},
             {in.motion, pointSampler},
             {in.depth, pointSampler},
             {in.terms, pointSampler},
             {in.material, pointSampler},
             {colors[older], linearSampler},
             {guides[older], pointSampler},
             colors[newest],
             guides[newest],
             {in.layer ? in.layer->view() : in.depth, pointSampler}},
            shared::TemporalParams{.texelSize = 1.0f / vec(in.color.extent),
                                   .last = lastRead(in.live, in.color.extent),
                                   .live = vec(in.live),
                                   .jitter = in.jitter,
                                   .size = {size.width, size.height},
                                   .falloff = 1.44269504f / (2 * options.width * options.width),
                                   .memory = options.memory * (in.moved ? 1 : kStillMemory),
                                   .known = known,
                                   .moved = in.moved,
                                   .layered = in.layer != nullptr});
    }
    rec.barrier(Stage::compute, Stage::compute);
    const auto pass = rec.pass("sharpen");
    rec.dispatch(*show, gpu::groups8x8(size), {{colors[newest], pointSampler}, output},
                 shared::TemporalShowParams{.size = {size.width, size.height},
                                            .sharpness = options.sharpness});
}

}  // namespace lodestar::scale

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/recorder.hpp>

namespace lodestar::gpu {
namespace {

constexpr std::uint32_t kMaxPasses = 128;

struct StageAccess {
    vk::PipelineStageFlags2 stages;
    vk::AccessFlags2 reads, writes;
};

StageAccess accessOf(Stage stage) {
    using S = vk::PipelineStageFlagBits2;
    using A = vk::AccessFlagBits2;
    switch (stage) {
        case Stage::compute:
            return {S::eComputeShader,
                    A::eShaderStorageRead | A::eShaderSampledRead | A::eUniformRead,
                    A::eShaderStorageWrite};
        case Stage::raster:
            return {S::eVertexShader | S::eFragmentShader | S::eEarlyFragmentTests |
                        S::eLateFragmentTests | S::eColorAttachmentOutput,
                    A::eShaderStorageRead | A::eShaderSampledRead | A::eUniformRead |
                        A::eDepthStencilAttachmentRead | A::eColorAttachmentRead |
                        A::eDepthStencilAttachmentWrite | A::eColorAttachmentWrite,
                    A::eDepthStencilAttachmentWrite | A::eColorAttachmentWrite};
        case Stage::indirect:
            return {S::eDrawIndirect, A::eIndirectCommandRead, {}};
        case Stage::transfer:
            return {S::eAllTransfer, A::eTransferRead | A::eTransferWrite, A::eTransferWrite};
        case Stage::host:
            return {S::eHost, A::eHostRead, A::eHostWrite};
    }
    throw std::invalid_argument("Stage");
}

}  // namespace

Recorder::Recorder(const Device& device)
    : owner(&device),
      pool(device.vk(),
           vk::CommandPoolCreateInfo{.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                     .queueFamilyIndex = device.queueFamily()}),
      fence(device.vk(), vk::FenceCreateInfo{}),
      allTiles(makeTexelBuffer(device, "all tiles", std::vector{~std::uint32_t{0}},
                               vk::Format::eR32Uint)),
      flushesLate(device.description().type == "Cpu") {
    vk::raii::CommandBuffers buffers(
        device.vk(),
        {.commandPool = *pool, .level = vk::CommandBufferLevel::ePrimary, .commandBufferCount = 1});
    commands = std::move(buffers.front());
    if (device.timestampMs() > 0)
        queries = vk::raii::QueryPool(
            device.vk(), {.queryType = vk::QueryType::eTimestamp, .queryCount = 2 * kMaxPasses});
}

void Recorder::begin() {
    commands.reset();
    commands.begin({.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    names.clear();
    queryCount = 0;
    if (*queries) commands.resetQueryPool(*queries, 0, 2 * kMaxPasses);
}

void Recorder::timestamp() {
    if (!*queries) return;
    commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *queries, queryCount++);
    // Mesa's CPU driver takes a timestamp only when it next flushes, which may be after the work
    // that follows. A barrier makes it flush.
    if (flushesLate) {
        constexpr auto kAll = vk::PipelineStageFlagBits2::eAllCommands;
        const vk::MemoryBarrier2 flush{.srcStageMask = kAll, .dstStageMask = kAll};
        commands.pipelineBarrier2({.memoryBarrierCount = 1, .pMemoryBarriers = &flush});
    }
}

Recorder::Pass Recorder::pass(const std::string& name) {
    if (passOpen)
        throw std::invalid_argument("Recorder::pass: '" + name + "' opened inside a pass");
    if (names.size() == kMaxPasses) throw std::invalid_argument("Recorder::pass: over 128 passes");
    passOpen = true;
    names.push_back(name);
    if (owner->hasDebugNames()) commands.beginDebugUtilsLabelEXT({.pLabelName = name.c_str()});
    timestamp();
    return Pass(*this);
}

Recorder::Pass::~Pass() {
    recorder->endPass();
}

void Recorder::endPass() {
    timestamp();
    if (owner->hasDebugNames()) commands.endDebugUtilsLabelEXT();
    passOpen = false;
}

void Recorder::barrier(Stage from, Stage to) {
    const StageAccess source = accessOf(from), destination = accessOf(to);
    const vk::MemoryBarrier2 memory{.srcStageMask = source.stages,
                                    .srcAccessMask = source.writes,
                                    .dstStageMask = destination.stages,
                                    .dstAccessMask = destination.reads | destination.writes};
    commands.pipelineBarrier2({.memoryBarrierCount = 1, .pMemoryBarriers = &memory});
}

void Recorder::bind(const Kernel& kernel, const std::vector<Binding>& bindings,
                    std::span<const std::byte> params) {
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *kernel.pipeline());
    kernel.layout().push(commands, vk::PipelineBindPoint::eCompute, bindings, params);
}

void Recorder::beginRendering(const Target& target) {
    const vk::Extent2D extent =
        target.depth.view ? target.depth.extent : target.colors.at(0).extent;
    const auto attachment = [&](const View& view) {
        return vk::RenderingAttachmentInfo{
            .imageView = view.view,
            .imageLayout = vk::ImageLayout::eGeneral,
            .loadOp = target.keep ? vk::AttachmentLoadOp::eLoad : vk::AttachmentLoadOp::eClear,
            .storeOp = vk::AttachmentStoreOp::eStore};
    };
    std::vector<vk::RenderingAttachmentInfo> colors;
    for (const View& color : target.colors) colors.push_back(attachment(color));
    const vk::RenderingAttachmentInfo depth = attachment(target.depth);
    commands.beginRendering({.renderArea = {.extent = extent},
                             .layerCount = 1,
                             .colorAttachmentCount = static_cast<std::uint32_t>(colors.size()),
                             .pColorAttachments = colors.data(),
                             .pDepthAttachment = target.depth.view ? &depth : nullptr});
    commands.setViewport(0, vk::Viewport{.width = static_cast<float>(extent.width),
                                         .height = static_cast<float>(extent.height),
                                         .maxDepth = 1});
    commands.setScissor(0, vk::Rect2D{.extent = extent});
}

void Recorder::endRendering() {
    commands.endRendering();
}

void Recorder::bind(const RasterPipeline& pipeline, const std::vector<Binding>& bindings,
                    std::span<const std::byte> params) {
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline.pipeline());
    pipeline.layout().push(commands, vk::PipelineBindPoint::eGraphics, bindings, params);
}

void Recorder::fill(const Buffer& buffer, std::uint32_t value) {
    commands.fillBuffer(buffer.vk(), 0, VK_WHOLE_SIZE, value);
}

void Recorder::clear(const View& image, const glm::vec4& value) {
    commands.clearColorImage(
        image.image, vk::ImageLayout::eGeneral,
        vk::ClearColorValue(value.x, value.y, value.z, value.w),
        vk::ImageSubresourceRange{.aspectMask = vk::ImageAspectFlagBits::eColor,
                                  .levelCount = image.levels,
                                  .layerCount = image.layers});
}

void Recorder::copy(const Buffer& from, const Buffer& to, std::uint64_t bytes,
                    std::uint64_t fromOffset) {
    commands.copyBuffer(from.vk(), to.vk(), vk::BufferCopy{.srcOffset = fromOffset, .size = bytes});
}

void FrameTimes::precede(const FrameTimes& before) {
    gpuMs += before.gpuMs;
    wallMs += before.wallMs;
    passes.insert(passes.begin(), before.passes.begin(), before.passes.end());
}

FrameTimes Recorder::submit() {
    commands.end();
    const auto start = std::chrono::steady_clock::now();
    const vk::CommandBuffer handle = *commands;
    owner->queue().submit(vk::SubmitInfo{.commandBufferCount = 1, .pCommandBuffers = &handle},
                          *fence);
    if (owner->vk().waitForFences(*fence, true, UINT64_MAX) != vk::Result::eSuccess)
        throw DeviceError("waiting for the frame failed");
    owner->vk().resetFences(*fence);

    FrameTimes times;
    times.wallMs =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    times.gpuMs = times.wallMs;
    if (*queries && queryCount > 0) {
        const auto [result, ticks] = queries.getResults<std::uint64_t>(
            0, queryCount, queryCount * sizeof(std::uint64_t), sizeof(std::uint64_t),
            vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
        const double unit = owner->timestampMs();
        for (std::size_t i = 0; i < names.size(); ++i)
            times.passes.push_back(
                {names[i], static_cast<double>(ticks[2 * i + 1] - ticks[2 * i]) * unit});
        times.gpuMs = static_cast<double>(ticks.back() - ticks.front()) * unit;
    }
    return times;
}

}  // namespace lodestar::gpu

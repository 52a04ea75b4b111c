// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/readback.hpp>

#include <algorithm>

namespace lodestar::gpu {
namespace {

constexpr vk::MemoryBarrier2 kAllToTransfer{
    .srcStageMask = vk::PipelineStageFlagBits2::eAllCommands,
    .srcAccessMask = vk::AccessFlagBits2::eMemoryWrite,
    .dstStageMask = vk::PipelineStageFlagBits2::eAllTransfer,
    .dstAccessMask = vk::AccessFlagBits2::eTransferRead | vk::AccessFlagBits2::eTransferWrite};
constexpr vk::MemoryBarrier2 kTransferToAll{
    .srcStageMask = vk::PipelineStageFlagBits2::eAllTransfer,
    .srcAccessMask = vk::AccessFlagBits2::eTransferWrite,
    .dstStageMask = vk::PipelineStageFlagBits2::eAllCommands | vk::PipelineStageFlagBits2::eHost,
    .dstAccessMask = vk::AccessFlagBits2::eMemoryRead | vk::AccessFlagBits2::eHostRead};

void between(const vk::raii::CommandBuffer& commands, const vk::MemoryBarrier2& barrier) {
    commands.pipelineBarrier2({.memoryBarrierCount = 1, .pMemoryBarriers = &barrier});
}

vk::BufferImageCopy copyOf(const View& view, std::uint32_t level, std::uint32_t layer,
                           std::uint32_t layers) {
    return {
        .imageSubresource = {.aspectMask = isDepth(view.format) ? vk::ImageAspectFlagBits::eDepth
                                                                : vk::ImageAspectFlagBits::eColor,
                             .mipLevel = view.firstLevel + level,
                             .baseArrayLayer = layer,
                             .layerCount = layers},
        .imageExtent = {std::max(1u, view.extent.width >> level),
                        std::max(1u, view.extent.height >> level), 1}};
}

std::vector<std::byte> copyOut(const Buffer& staging, std::uint64_t bytes) {
    const auto* begin = staging.mapped();
    return {begin, begin + bytes};
}

}  // namespace

std::vector<std::byte> readImage(const Device& device, const View& view, std::uint32_t layer) {
    const std::uint64_t bytes = texelBytes(view.format) * view.extent.width * view.extent.height;
    const Buffer staging(device, "read-back", bytes, Residence::mapped);
    device.runNow([&](const vk::raii::CommandBuffer& commands) {
        between(commands, kAllToTransfer);
        commands.copyImageToBuffer(view.image, vk::ImageLayout::eGeneral, staging.vk(),
                                   copyOf(view, 0, layer, 1));
        between(commands, kTransferToAll);
    });
    return copyOut(staging, bytes);
}

std::vector<std::byte> readBuffer(const Device& device, const Buffer& buffer, std::uint64_t bytes) {
    const Buffer staging(device, "read-back", bytes, Residence::mapped);
    device.runNow([&](const vk::raii::CommandBuffer& commands) {
        between(commands, kAllToTransfer);
        commands.copyBuffer(buffer.vk(), staging.vk(), vk::BufferCopy{.size = bytes});
        between(commands, kTransferToAll);
    });
    return copyOut(staging, bytes);
}

void uploadImage(const Device& device, const View& view, std::uint32_t level,
                 std::span<const std::byte> texels) {
    Buffer staging(device, "upload", texels.size(), Residence::mapped);
    staging.upload(texels);
    device.runNow([&](const vk::raii::CommandBuffer& commands) {
        between(commands, kAllToTransfer);
        commands.copyBufferToImage(staging.vk(), view.image, vk::ImageLayout::eGeneral,
                                   copyOf(view, level, 0, view.layers));
        between(commands, kTransferToAll);
    });
}

}  // namespace lodestar::gpu

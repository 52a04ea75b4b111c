// SPDX-License-Identifier: Apache-2.0
#include <lodestar/gpu/image.hpp>

#include <fmt/format.h>

namespace lodestar::gpu {

bool isDepth(vk::Format format) {
    return format == vk::Format::eD32Sfloat;
}

std::size_t texelBytes(vk::Format format) {
    switch (format) {
        case vk::Format::eR8G8B8A8Unorm:
        case vk::Format::eR8G8B8A8Srgb:
        case vk::Format::eR32Uint:
        case vk::Format::eR32Sfloat:
        case vk::Format::eR16G16Snorm:
        case vk::Format::eD32Sfloat:
            return 4;
        case vk::Format::eR16G16B16A16Sfloat:
        case vk::Format::eR32G32Uint:
        case vk::Format::eR32G32Sfloat:
            return 8;
        case vk::Format::eR32G32B32A32Uint:
        case vk::Format::eR32G32B32A32Sfloat:
            return 16;
        default:
            throw std::invalid_argument("texelBytes: format " + vk::to_string(format));
    }
}

Image::Image(const Device& owner, const ImageInfo& info) : device(&owner) {
    if (info.extent.width == 0 || info.extent.height == 0)
        throw std::invalid_argument("ImageInfo::extent: 0 in image '" + info.name + "'");
    image = vk::raii::Image(
        owner.vk(), vk::ImageCreateInfo{.imageType = vk::ImageType::e2D,
                                        .format = info.format,
                                        .extent = {info.extent.width, info.extent.height, 1},
                                        .mipLevels = info.levels,
                                        .arrayLayers = info.layers,
                                        .samples = vk::SampleCountFlagBits(info.samples),
                                        .tiling = vk::ImageTiling::eOptimal,
                                        .usage = info.usage});
    memory = owner.allocate(image.getMemoryRequirements(), vk::MemoryPropertyFlagBits::eDeviceLocal,
                            info.name);
    image.bindMemory(*memory, 0);
    owner.name(image, info.name);

    const vk::ImageSubresourceRange range{.aspectMask = isDepth(info.format)
                                                            ? vk::ImageAspectFlagBits::eDepth
                                                            : vk::ImageAspectFlagBits::eColor,
                                          .levelCount = info.levels,
                                          .layerCount = info.layers};
    const bool array = info.array || info.layers > 1;
    const auto viewOf = [&](std::uint32_t base, std::uint32_t count) {
        vk::ImageSubresourceRange part = range;
        part.baseMipLevel = base;
        part.levelCount = count;
        vk::raii::ImageView view(
            owner.vk(), vk::ImageViewCreateInfo{.image = *image,
                                                .viewType = array ? vk::ImageViewType::e2DArray
                                                                  : vk::ImageViewType::e2D,
                                                .format = info.format,
                                                .subresourceRange = part});
        owner.name(view, fmt::format("{} levels {}+{}", info.name, base, count));
        return view;
    };
    allLevels = viewOf(0, info.levels);
    if (info.levels > 1)
        for (std::uint32_t l = 0; l < info.levels; ++l) singleLevels.push_back(viewOf(l, 1));
    if (array && info.usage & vk::ImageUsageFlagBits::eDepthStencilAttachment)
        for (std::uint32_t l = 0; l < info.layers; ++l) {
            vk::ImageSubresourceRange part = range;
            part.baseArrayLayer = l;
            part.layerCount = 1;
            singleLayers.emplace_back(owner.vk(),
                                      vk::ImageViewCreateInfo{.image = *image,
                                                              .viewType = vk::ImageViewType::e2D,
                                                              .format = info.format,
                                                              .subresourceRange = part});
            owner.name(singleLayers.back(), fmt::format("{} layer {}", info.name, l));
        }
    whole = {*allLevels, *image, info.format, info.extent, info.layers, info.levels, 0};

    owner.runNow([&](const vk::raii::CommandBuffer& commands) {
        const vk::ImageMemoryBarrier2 toGeneral{
            .srcStageMask = vk::PipelineStageFlagBits2::eNone,
            .dstStageMask = vk::PipelineStageFlagBits2::eAllCommands,
            .dstAccessMask = vk::AccessFlagBits2::eMemoryRead | vk::AccessFlagBits2::eMemoryWrite,
            .oldLayout = vk::ImageLayout::eUndefined,
            .newLayout = vk::ImageLayout::eGeneral,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = *image,
            .subresourceRange = range};
        commands.pipelineBarrier2(
            {.imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &toGeneral});
    });
}

Image::~Image() {
    if (*memory) device->release(memory);
}

Image& Image::operator=(Image&& other) {
    if (*memory) device->release(memory);
    device = other.device;
    singleLevels = std::move(other.singleLevels);
    singleLayers = std::move(other.singleLayers);
    allLevels = std::move(other.allLevels);
    image = std::move(other.image);
    memory = std::move(other.memory);
    whole = other.whole;
    return *this;
}

View Image::level(std::uint32_t level) const {
    if (singleLevels.empty()) return whole;
    View view = whole;
    view.view = *singleLevels.at(level);
    view.levels = 1;
    view.firstLevel = level;
    view.extent = vk::Extent2D{std::max(1u, whole.extent.width >> level),
                               std::max(1u, whole.extent.height >> level)};
    return view;
}

View Image::layer(std::uint32_t layer) const {
    View view = whole;
    view.view = *singleLayers.at(layer);
    view.layers = 1;
    return view;
}

}  // namespace lodestar::gpu

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <lodestar/gpu/device.hpp>

namespace lodestar::gpu {

/// A borrowed image view with what a pass must know about it. The image is in layout GENERAL.
struct View {
    vk::ImageView view;
    vk::Image image;
    vk::Format format = vk::Format::eUndefined;
    vk::Extent2D extent;  ///< of level 0 of the view
    std::uint32_t layers = 1, levels = 1;
    std::uint32_t firstLevel = 0;  ///< of the image, where the view's level 0 lies
};

/// The part of a view from its first texel on: what a pass may read and write of a target that is
/// larger than this frame needs.
inline View part(View view, vk::Extent2D extent) {
    view.extent = extent;
    return view;
}

struct ImageInfo {
    std::string name;
    vk::Format format = vk::Format::eUndefined;
    vk::Extent2D extent;
    vk::ImageUsageFlags usage;
    std::uint32_t layers = 1, levels = 1;
    bool array = false;  ///< view as a 2D array, even with one layer
    std::uint32_t samples = 1;
};

/// A 2D image (array) with its own memory, in layout GENERAL from the start.
class Image {
public:
    /// Throws std::invalid_argument on an extent of 0, Vulkan-Hpp's exceptions out of memory.
    Image(const Device&, const ImageInfo&);
    ~Image();
    Image(Image&&) = default;
    Image& operator=(Image&&);

    const View& view() const { return whole; }
    /// One mip level alone, as a storage image needs it.
    View level(std::uint32_t level) const;
    /// One layer of a depth-attachment array alone, to draw to.
    View layer(std::uint32_t layer) const;
    operator const View&() const { return whole; }
    vk::Extent2D extent() const { return whole.extent; }

private:
    const Device* device;
    vk::raii::DeviceMemory memory{nullptr};
    vk::raii::Image image{nullptr};
    vk::raii::ImageView allLevels{nullptr};
    std::vector<vk::raii::ImageView> singleLevels, singleLayers;
    View whole;
};

/// Texels of one pixel, in bytes, for the formats lodestar uses. Throws std::invalid_argument.
std::size_t texelBytes(vk::Format);
bool isDepth(vk::Format);

}  // namespace lodestar::gpu

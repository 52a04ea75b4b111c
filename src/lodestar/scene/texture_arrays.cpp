// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/texture_arrays.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>

#include <lodestar/scene/mipmaps.hpp>
#include <lodestar/shared/parallel.hpp>

namespace lodestar::scene {
namespace {

constexpr std::uint32_t kMaxLayers = 2048;  // what every Vulkan 1.3 device has at least

/// One layer to be: an image, read in one colour space. How it wraps matters only for enlarging.
struct Layer {
    std::uint32_t image = 0;
    Wrap wrapU = Wrap::repeat, wrapV = Wrap::repeat;
    bool nearest = false;
};

/// Layers that will share one size.
struct SizeClass {
    int width = 0, height = 0;
    ColorSpace space = ColorSpace::linear;
    std::vector<std::uint32_t> layers;  // indices of the list of all layers

    std::uint64_t area() const { return std::uint64_t(width) * std::uint64_t(height); }
    std::uint64_t arrays() const { return (layers.size() + kMaxLayers - 1) / kMaxLayers; }
};

std::uint32_t mipLevelsOf(int width, int height) {
    return static_cast<std::uint32_t>(
        std::bit_width(static_cast<unsigned>(std::max(width, height))));
}

const Image& checkedImage(const Scene& scene, const Texture& texture) {
    if (texture.image >= scene.images.size())
        throw std::invalid_argument("buildTextureArrays: a texture names an image there is not");
    const Image& image = scene.images[texture.image];
    if (image.width <= 0 || image.height <= 0 ||
        image.rgba.size() != std::size_t(image.width) * std::size_t(image.height) * 4)
        throw std::invalid_argument("buildTextureArrays: image '" + image.name +
                                    "' does not have width x height RGBA texels");
    return image;
}

/// Makes two classes one until there are few enough arrays. The pair whose union adds the fewest
/// texels goes first: a small size into the next one. No image ever shrinks.
void mergeClasses(std::vector<SizeClass>& classes) {
    const auto arrayCount = [&] {
        std::uint64_t count = 0;
        for (const SizeClass& c : classes) count += c.arrays();
        return count;
    };
    while (arrayCount() > kMaxTextureArrays) {
        std::uint64_t bestCost = std::numeric_limits<std::uint64_t>::max();
        std::size_t bestA = 0, bestB = 0;
        for (std::size_t a = 0; a < classes.size(); ++a)
            for (std::size_t b = a + 1; b < classes.size(); ++b) {
                const SizeClass &ca = classes[a], &cb = classes[b];
                if (ca.space != cb.space) continue;
                const std::uint64_t area = std::uint64_t(std::max(ca.width, cb.width)) *
                                           std::uint64_t(std::max(ca.height, cb.height));
                const std::uint64_t cost =
                    (area - ca.area()) * ca.layers.size() + (area - cb.area()) * cb.layers.size();
                if (cost < bestCost) std::tie(bestCost, bestA, bestB) = std::tuple(cost, a, b);
            }
        if (bestB == 0)  // one class a space is left, and it is the layers that are too many
            throw std::invalid_argument(
                "buildTextureArrays: more textures than the arrays have layers");
        SizeClass& into = classes[bestA];
        const SizeClass from = std::move(classes[bestB]);
        classes.erase(classes.begin() + static_cast<std::ptrdiff_t>(bestB));
        into.width = std::max(into.width, from.width);
        into.height = std::max(into.height, from.height);
        into.layers.insert(into.layers.end(), from.layers.begin(), from.layers.end());
    }
}

void fillLayer(TextureArray& array, std::uint32_t layer, const Image& image, const Layer& use) {
    const bool fits = image.width == array.width && image.height == array.height;
    const std::vector<std::uint8_t> enlarged =
        fits ? std::vector<std::uint8_t>()
             : resized(image, array.width, array.height, array.space, use.wrapU, use.wrapV,
                       use.nearest);
    const std::uint8_t* base = fits ? image.rgba.data() : enlarged.data();
    std::uint8_t* texels = array.texels.data();
    const std::size_t bytes = std::size_t(array.width) * std::size_t(array.height) * 4;
    std::memcpy(texels + layer * bytes, base, bytes);

    std::vector<std::uint8_t*> levels;
    for (std::uint32_t level = 1; level < array.mipLevels; ++level) {
        const std::size_t size = std::size_t(std::max(1, array.width >> level)) *
                                 std::size_t(std::max(1, array.height >> level)) * 4;
        levels.push_back(texels + array.levelOffset(level) + layer * size);
    }
    writeMips(base, array.width, array.height, array.space, levels);
}

}  // namespace

std::size_t TextureArray::levelOffset(std::uint32_t level) const {
    std::size_t offset = 0;
    for (std::uint32_t i = 0; i < level; ++i)
        offset += std::size_t(std::max(1, width >> i)) * std::size_t(std::max(1, height >> i)) *
                  layers * 4;
    return offset;
}

TextureArrays buildTextureArrays(const Scene& scene) {
    std::vector<Layer> layers;
    std::vector<std::uint32_t> layerOf;  // a texture → its layer
    std::map<std::pair<std::uint32_t, ColorSpace>, std::uint32_t> known;
    std::vector<SizeClass> classes;
    std::map<std::tuple<int, int, ColorSpace>, std::size_t> classOf;
    for (const Texture& texture : scene.textures) {
        const Image& image = checkedImage(scene, texture);
        const auto number = static_cast<std::uint32_t>(layers.size());
        const auto [entry, added] = known.try_emplace({texture.image, texture.space}, number);
        layerOf.push_back(entry->second);
        if (!added) continue;
        layers.push_back({texture.image, texture.wrapU, texture.wrapV, texture.nearest});
        const auto [place, fresh] =
            classOf.try_emplace({image.width, image.height, texture.space}, classes.size());
        if (fresh) classes.push_back({image.width, image.height, texture.space, {}});
        classes[place->second].layers.push_back(number);
    }
    mergeClasses(classes);

    TextureArrays result;
    std::vector<TextureSlot> slots(layers.size());
    for (const SizeClass& c : classes)
        for (std::size_t first = 0; first < c.layers.size(); first += kMaxLayers) {
            TextureArray array;
            array.width = c.width;
            array.height = c.height;
            array.space = c.space;
            array.mipLevels = mipLevelsOf(c.width, c.height);
            array.layers = static_cast<std::uint32_t>(
                std::min<std::size_t>(kMaxLayers, c.layers.size() - first));
            array.texels.resize(array.levelOffset(array.mipLevels));
            for (std::uint32_t layer = 0; layer < array.layers; ++layer)
                slots[c.layers[first + layer]] = {static_cast<std::uint32_t>(result.arrays.size()),
                                                  layer};
            result.arrays.push_back(std::move(array));
        }
    parallelFor(layers.size(), [&](std::size_t i) {
        fillLayer(result.arrays[slots[i].array], slots[i].layer, scene.images[layers[i].image],
                  layers[i]);
    });
    for (std::uint32_t layer : layerOf) result.slotOf.push_back(slots[layer]);
    return result;
}

}  // namespace lodestar::scene

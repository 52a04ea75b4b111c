// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <lodestar/scene/decode_image.hpp>
#include <lodestar/scene/import_gltf_convert.hpp>
#include <lodestar/shared/parallel.hpp>

namespace lodestar::scene::gltf {

namespace {

constexpr std::uint64_t kMaxAllTexels = 512ull << 20;  // of all images: 2 GiB
constexpr std::uint64_t kMaxFile = 1ull << 30;

struct Encoded {
    std::string name, place;
    std::vector<std::uint8_t> owned;  ///< if not part of a buffer
    Bytes bytes;
    ImageSize size;
};

[[noreturn]] void refuseImage(const Encoded& image, const std::string& what) {
    refuse(image.place, what, "replace the image by a sound PNG or JPEG");
}

Encoded encodedImage(Document& document, std::size_t index) {
    const Place place = document.root().get("images")[index];
    Encoded image;
    image.place = place.path();
    if (const std::optional<Place> name = place.find("name"); name && name->json().is_string())
        image.name = cleaned(name->text());
    if (const std::optional<Place> uri = place.find("uri")) {
        if (!uri->text().starts_with("data:")) {
            image.place += " '" + cleaned(uri->text()) + "'";
            if (image.name.empty()) image.name = cleaned(uri->text());
        }
        image.owned = readUri(document, *uri, 1, kMaxFile);
        image.bytes = image.owned;
    } else {
        image.bytes = viewBytes(document, place.get("bufferView").whole());
    }
    if (!isPng(image.bytes) && !isJpeg(image.bytes))
        refuseImage(image, "is neither a PNG nor a JPEG");
    const auto size = readImageSize(image.bytes);
    if (!size) refuseImage(image, size.error().message);
    image.size = *size;
    return image;
}

Image decoded(const Encoded& image) {
    auto result = decodeImage(image.name, image.bytes);
    if (!result) refuseImage(image, result.error().message);
    return std::move(*result);
}

}  // namespace

std::vector<Image> decodeImages(Document& document, const std::vector<std::size_t>& images) {
    std::vector<Encoded> encoded;
    std::uint64_t texels = 0;
    for (const std::size_t index : images) {
        encoded.push_back(encodedImage(document, index));
        Encoded& last = encoded.back();
        if (!last.owned.empty()) last.bytes = last.owned;
        texels += static_cast<std::uint64_t>(last.size.width) *
                  static_cast<std::uint64_t>(last.size.height);
        if (texels > kMaxAllTexels)
            refuseImage(last, fmt::format("the images add up to over {} texels", kMaxAllTexels));
    }
    std::vector<Image> results(encoded.size());
    parallelFor(encoded.size(), [&](std::size_t i) { results[i] = decoded(encoded[i]); });
    return results;
}

}  // namespace lodestar::scene::gltf

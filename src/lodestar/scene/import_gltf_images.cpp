// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <climits>
#include <cstring>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <stb_image.h>

#include <lodestar/scene/import_gltf_convert.hpp>

namespace lodestar::scene::gltf {

namespace {

constexpr int kMaxSide = 16384;                        // what the floor device can hold
constexpr std::uint64_t kMaxPixels = 64ull << 20;      // of one image
constexpr std::uint64_t kMaxAllPixels = 512ull << 20;  // of all: 2 GiB
constexpr std::uint64_t kMaxFile = 1ull << 30;

struct Encoded {
    std::string name, place;
    std::vector<std::uint8_t> owned;  ///< if not part of a buffer
    Bytes bytes;
    int width = 0, height = 0;
};

[[noreturn]] void refuseImage(const Encoded& image, const std::string& what) {
    refuse(image.place, what, "replace the image by a sound PNG or JPEG");
}

std::uint32_t bigEndianWord(Bytes bytes, std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
           std::uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
}

bool startsWith(Bytes bytes, std::string_view magic) {
    return bytes.size() >= magic.size() &&
           std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

bool isPng(Bytes bytes) {
    return startsWith(bytes, {"\x89PNG\r\n\x1a\n", 8});
}
bool isJpeg(Bytes bytes) {
    return startsWith(bytes, "\xff\xd8\xff");
}

/// stb_image inflates all of a PNG's data however small the picture, up to a thousandfold. Where
/// that could pass half a gigabyte, the data is inflated first into just the room it may take.
void checkPngInflation(const Encoded& image) {
    constexpr std::uint64_t kMaxRatio = 1032, kHarmless = 512ull << 20;
    const Bytes bytes = image.bytes;
    std::vector<std::uint8_t> data;
    std::size_t at = 8;
    while (bytes.size() - at >= 12) {
        const std::uint32_t length = bigEndianWord(bytes, at);
        if (length > bytes.size() - at - 12) break;
        if (std::memcmp(bytes.data() + at + 4, "IDAT", 4) == 0)
            data.insert(data.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at + 8),
                        bytes.begin() + static_cast<std::ptrdiff_t>(at + 8 + length));
        at += std::size_t{12} + length;
    }
    if (data.size() * kMaxRatio <= kHarmless || bytes.size() < 26) return;
    const std::uint64_t bits = bytes[24];
    const std::uint64_t channels = bytes[25] == 6 ? 4 : bytes[25] == 2 ? 3 : bytes[25] == 4 ? 2 : 1;
    const auto width = static_cast<std::uint64_t>(image.width);
    const auto height = static_cast<std::uint64_t>(image.height);
    // The seven passes of an interlaced image have some more, shorter rows.
    const std::uint64_t room = ((width * channels * bits + 7) / 8 + 1) * (height + 8) * 5 / 4 + 64;
    std::vector<char> inflated(room);
    if (room > INT_MAX || data.size() > INT_MAX ||
        stbi_zlib_decode_buffer(inflated.data(), static_cast<int>(room),
                                reinterpret_cast<const char*>(data.data()),
                                static_cast<int>(data.size())) < 0)
        refuseImage(image, "its PNG data is damaged or larger than the picture");
}

/// Each scan of a progressive JPEG visits every block of the picture, and an empty one takes ten
/// bytes of the file. Encoders write about ten scans.
void checkJpegScans(const Encoded& image) {
    constexpr int kMaxScans = 100;
    int scans = 0;
    for (std::size_t i = 0; i + 1 < image.bytes.size(); ++i)
        if (image.bytes[i] == 0xff && image.bytes[i + 1] == 0xda) ++scans;
    if (scans > kMaxScans) refuseImage(image, fmt::format("its JPEG data has {} scans", scans));
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
    int channels = 0;
    if (image.bytes.size() > INT_MAX ||
        !stbi_info_from_memory(image.bytes.data(), static_cast<int>(image.bytes.size()),
                               &image.width, &image.height, &channels))
        refuseImage(image, "its header is damaged");
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
    if (image.width < 1 || image.height < 1 || image.width > kMaxSide || image.height > kMaxSide ||
        pixels > kMaxPixels)
        refuseImage(image, fmt::format("{} x {} pixels are over the limit of {} a side and {} in "
                                       "all",
                                       image.width, image.height, kMaxSide, kMaxPixels));
    if (isJpeg(image.bytes)) checkJpegScans(image);
    return image;
}

Image decoded(const Encoded& image) {
    if (isPng(image.bytes)) checkPngInflation(image);
    Image result;
    result.name = image.name;
    int channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(image.bytes.data(), static_cast<int>(image.bytes.size()),
                              &result.width, &result.height, &channels, 4),
        stbi_image_free);
    if (!pixels || result.width != image.width || result.height != image.height)
        refuseImage(image, "can't be decoded");
    const std::size_t size =
        4 * static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height);
    result.rgba.assign(pixels.get(), pixels.get() + size);
    return result;
}

}  // namespace

std::vector<Image> decodeImages(Document& document, const std::vector<std::size_t>& images) {
    std::vector<Encoded> encoded;
    std::uint64_t pixels = 0;
    for (const std::size_t index : images) {
        encoded.push_back(encodedImage(document, index));
        Encoded& last = encoded.back();
        if (!last.owned.empty()) last.bytes = last.owned;
        pixels += static_cast<std::uint64_t>(last.width) * static_cast<std::uint64_t>(last.height);
        if (pixels > kMaxAllPixels)
            refuseImage(last, fmt::format("the images add up to over {} pixels", kMaxAllPixels));
    }
    std::vector<Image> results(encoded.size());
    std::vector<std::exception_ptr> failures(encoded.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        for (std::size_t i = next++; i < encoded.size(); i = next++) {
            try {
                results[i] = decoded(encoded[i]);
            } catch (...) {
                failures[i] = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> helpers;
        const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
        for (std::size_t i = 1; i < std::min(cores, encoded.size()); ++i)
            helpers.emplace_back(work);
        work();
    }
    for (const std::exception_ptr& failure : failures)  // the first in the file's order
        if (failure) std::rethrow_exception(failure);
    return results;
}

}  // namespace lodestar::scene::gltf

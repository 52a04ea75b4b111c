// SPDX-License-Identifier: Apache-2.0
#include <lodestar/scene/decode_image.hpp>

#include <climits>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <stb_image.h>

namespace lodestar::scene {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::int64_t kMaxSide = 16384;  // what the floor device can hold
constexpr std::int64_t kMaxTexels = 64ll << 20;

bool startsWith(Bytes bytes, std::string_view magic) {
    return bytes.size() >= magic.size() &&
           std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

std::uint32_t bigEndianWord(Bytes bytes, std::size_t at) {
    return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
           std::uint32_t{bytes[at + 2]} << 8 | bytes[at + 3];
}

/// stb_image inflates all of a PNG's data however small the picture, up to a thousandfold. Where
/// that could pass half a gigabyte, the data is inflated first into just the room it may take.
Result<void> checkPngInflation(Bytes bytes, ImageSize size) {
    constexpr std::uint64_t kMaxRatio = 1032, kHarmless = 512ull << 20;
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
    if (data.size() * kMaxRatio <= kHarmless || bytes.size() < 26) return {};
    const std::uint64_t bits = bytes[24];
    const std::uint64_t channels = bytes[25] == 6 ? 4 : bytes[25] == 2 ? 3 : bytes[25] == 4 ? 2 : 1;
    const auto width = static_cast<std::uint64_t>(size.width);
    const auto height = static_cast<std::uint64_t>(size.height);
    // The seven passes of an interlaced image have some more, shorter rows.
    const std::uint64_t room = ((width * channels * bits + 7) / 8 + 1) * (height + 8) * 5 / 4 + 64;
    std::vector<char> inflated(room);
    if (room > INT_MAX || data.size() > INT_MAX ||
        stbi_zlib_decode_buffer(inflated.data(), static_cast<int>(room),
                                reinterpret_cast<const char*>(data.data()),
                                static_cast<int>(data.size())) < 0)
        return fail("has PNG data that is damaged or larger than the picture");
    return {};
}

/// Each scan of a progressive JPEG visits every block of the picture, and an empty one takes ten
/// bytes of the file. Encoders write about ten scans.
Result<void> checkJpegScans(Bytes bytes) {
    constexpr int kMaxScans = 100;
    int scans = 0;
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i)
        if (bytes[i] == 0xff && bytes[i + 1] == 0xda) ++scans;
    if (scans > kMaxScans)
        return fail(fmt::format("has {} scans of JPEG data, {} at most", scans, kMaxScans));
    return {};
}

}  // namespace

bool isPng(Bytes bytes) {
    return startsWith(bytes, {"\x89PNG\r\n\x1a\n", 8});
}

bool isJpeg(Bytes bytes) {
    return startsWith(bytes, "\xff\xd8\xff");
}

Result<void> checkImageSize(std::int64_t width, std::int64_t height) {
    if (width < 1 || height < 1) return fail("has no texels");
    if (width > kMaxSide || height > kMaxSide || width * height > kMaxTexels)
        return fail(
            fmt::format("is too large: {} x {} texels are over the limit of {} a side and "
                        "{} in all",
                        width, height, kMaxSide, kMaxTexels));
    return {};
}

Result<ImageSize> readImageSize(Bytes bytes) {
    if (bytes.empty() || bytes.size() > INT_MAX) return fail("is empty or too large");
    ImageSize size;
    int channels = 0;
    if (!stbi_info_from_memory(bytes.data(), static_cast<int>(bytes.size()), &size.width,
                               &size.height, &channels))
        return fail("has a damaged header, or is of a kind that this program does not read");
    if (const auto allowed = checkImageSize(size.width, size.height); !allowed)
        return tl::unexpected(allowed.error());
    return size;
}

Result<Image> decodeImage(std::string name, Bytes bytes) {
    const Result<ImageSize> size = readImageSize(bytes);
    if (!size) return tl::unexpected(size.error());
    const Result<void> sound = isPng(bytes)    ? checkPngInflation(bytes, *size)
                               : isJpeg(bytes) ? checkJpegScans(bytes)
                                               : Result<void>();
    if (!sound) return tl::unexpected(sound.error());
    int width = 0, height = 0, channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
        stbi_load_from_memory(bytes.data(), static_cast<int>(bytes.size()), &width, &height,
                              &channels, 4),
        stbi_image_free);
    if (!pixels || width != size->width || height != size->height)
        return fail(fmt::format("can't be decoded ({})",
                                stbi_failure_reason() ? stbi_failure_reason() : "damaged"));
    const std::size_t count =
        4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    return Image{std::move(name), width, height, {pixels.get(), pixels.get() + count}};
}

}  // namespace lodestar::scene

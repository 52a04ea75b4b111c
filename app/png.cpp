// SPDX-License-Identifier: Apache-2.0
#include "png.hpp"

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <stb_image.h>
#include <stb_image_write.h>
#include <zlib.h>

#include "image_io.hpp"
#include "whole_file.hpp"

namespace lodestar::app {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);

/// Deflate never shrinks its input more than this (zlib's technical details page).
constexpr std::uint64_t kLargestDeflateRatio = 1032;

std::uint32_t bigEndian32(std::string_view bytes, std::size_t at) {
    const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(bytes[at + i])); };
    return byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
}

/// Checks what stb_image does not: that every chunk lies in the file and has the right checksum.
/// A picture with a flipped bit would otherwise be measured as if it were meant.
std::optional<std::string> chunkProblem(std::string_view bytes) {
    constexpr std::size_t kFraming = 12;  // length, type and checksum around the data
    for (std::size_t at = kSignature.size();;) {
        if (bytes.size() - at < kFraming) return fmt::format("it ends at byte {}", bytes.size());
        const std::size_t length = bigEndian32(bytes, at);
        if (length > bytes.size() - at - kFraming)
            return fmt::format("its chunk at byte {} reaches past its end", at);
        const std::string_view typeAndData = bytes.substr(at + 4, 4 + length);
        const auto checksum = ::crc32(0, reinterpret_cast<const Bytef*>(typeAndData.data()),
                                      uInt(typeAndData.size()));
        if (checksum != bigEndian32(bytes, at + 8 + length))
            return fmt::format("its chunk at byte {} has a wrong checksum", at);
        const std::string_view type = typeAndData.substr(0, 4);
        if (at == kSignature.size() && (type != "IHDR" || length != 13))
            return fmt::format("its first chunk, at byte {}, is no IHDR", at);
        if (type == "IEND") return std::nullopt;
        at += kFraming + length;
    }
}

struct PngHeader {
    std::uint32_t width, height;
    int bitDepth, colorType;
};

/// Only after chunkProblem() found none.
PngHeader readHeader(std::string_view bytes) {
    return {bigEndian32(bytes, 16), bigEndian32(bytes, 20), std::uint8_t(bytes[24]),
            std::uint8_t(bytes[25])};
}

std::uint64_t bytesOfPixels(const PngHeader& header) {
    constexpr int kChannels[] = {1, 0, 3, 1, 2, 0, 4};  // by PNG colour type
    const int channels = header.colorType <= 6 ? kChannels[header.colorType] : 0;
    return header.height * ((std::uint64_t(header.width) * channels * header.bitDepth + 7) / 8);
}

struct FreeByStb {
    void operator()(void* pixels) const { stbi_image_free(pixels); }
};

}  // namespace

bool looksLikePng(std::string_view bytes) {
    return bytes.substr(0, 8) == kSignature;
}

Result<quality::RgbImage> decodePng(std::string_view bytes, const std::string& name) {
    if (const auto problem = chunkProblem(bytes))
        return fail(fmt::format("{}: broken PNG, {}; make the file anew", name, *problem));
    const PngHeader header = readHeader(bytes);
    if (header.width > kMaxImageSide || header.height > kMaxImageSide)
        return fail(fmt::format("{}: {} x {} pixels are over the limit of {} a side; scale it down",
                                name, header.width, header.height, kMaxImageSide));
    if (bytesOfPixels(header) > kLargestDeflateRatio * bytes.size())
        return fail(fmt::format(
            "{}: broken PNG, {} bytes cannot hold the {} x {} pixels of its header (byte 16); make "
            "the file anew",
            name, bytes.size(), header.width, header.height));

    const auto* data = reinterpret_cast<const stbi_uc*>(bytes.data());
    const int size = int(bytes.size());
    int width = 0, height = 0, channelsInFile = 0;
    const bool deep = header.bitDepth == 16;
    // stb_image would cut 16 bits to their upper 8: take all and round.
    const std::unique_ptr<void, FreeByStb> pixels(
        deep ? static_cast<void*>(
                   stbi_load_16_from_memory(data, size, &width, &height, &channelsInFile, 3))
             : stbi_load_from_memory(data, size, &width, &height, &channelsInFile, 3));
    if (!pixels)
        return fail(
            fmt::format("{}: broken PNG, {}; make the file anew", name, stbi_failure_reason()));
    quality::RgbImage image(width, height);
    if (deep) {
        const auto* codes = static_cast<const std::uint16_t*>(pixels.get());
        for (std::size_t i = 0; i < image.rgb.size(); ++i)
            image.rgb[i] = std::uint8_t((codes[i] + 128) / 257);
    } else {
        const auto* codes = static_cast<const std::uint8_t*>(pixels.get());
        image.rgb.assign(codes, codes + image.rgb.size());
    }
    return image;
}

Result<void> writePng(const std::filesystem::path& path, const quality::RgbImage& image) {
    if (image.width <= 0 || image.height <= 0 ||
        image.rgb.size() != std::size_t(3) * image.width * image.height)
        throw std::invalid_argument("image: must hold 3 * width * height bytes, and a pixel");
    std::string bytes;
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data), std::size_t(size));
    };
    if (!stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(),
                                3 * image.width))
        return fail(fmt::format("{}: {} x {} pixels do not fit in memory as PNG; write it smaller",
                                path.string(), image.width, image.height));
    return writeWholeFile(path, bytes);
}

}  // namespace lodestar::app

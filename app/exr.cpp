// SPDX-License-Identifier: Apache-2.0
#include "exr.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <stdexcept>
#include <vector>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>
#include <fmt/format.h>

#include "image_io.hpp"
#include "png.hpp"
#include "whole_file.hpp"

namespace lodestar::app {
namespace {

/// Rows decoded between conversions, so that the float pixels never exist all at once.
constexpr int kRowsAtOnce = 64;
/// The most scanlines that one compressed chunk holds (DWAB).
constexpr int kMaxChunkRows = 256;
/// The most that decoding one chunk, or one row of tiles, may need.
constexpr std::uint64_t kMaxChunkBytes = std::uint64_t(1) << 31;

/// What is wrong with the file, thrown to decodeExr() as OpenEXR's own errors are.
struct ExrProblem : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class MemoryStream : public Imf::IStream {
public:
    MemoryStream(std::string_view content, const std::string& name)
        : IStream(name.c_str()), bytes(content) {}
    bool read(char to[], int count) override {
        if (count < 0 || position > bytes.size() || std::size_t(count) > bytes.size() - position)
            throw ExrProblem(fmt::format("it ends at byte {}", bytes.size()));
        std::memcpy(to, bytes.data() + position, std::size_t(count));
        position += std::size_t(count);
        return position < bytes.size();
    }
    std::uint64_t tellg() override { return position; }
    void seekg(std::uint64_t to) override { position = to; }

private:
    std::string_view bytes;
    std::uint64_t position = 0;
};

std::uint32_t littleEndian32(std::string_view bytes, std::size_t at) {
    const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(bytes[at + i])); };
    return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
}

/// OpenEXR allocates what an attribute's size field asks for before it reads the attribute: make
/// sure that each lies in the file.
void checkAttributes(std::string_view bytes) {
    if (bytes.size() < 8) throw ExrProblem(fmt::format("it ends at byte {}", bytes.size()));
    const int version = int(littleEndian32(bytes, 4));
    if (Imf::isMultiPart(version) || Imf::isNonImage(version))
        throw ExrProblem("it has several parts or deep pixels, which are not read; save it flat");
    std::size_t at = 8;
    const auto skipText = [&] {
        const std::size_t end = bytes.find('\0', at);
        if (end == bytes.npos) throw ExrProblem(fmt::format("its header never ends (byte {})", at));
        const bool empty = end == at;
        at = end + 1;
        return !empty;
    };
    while (skipText()) {  // an attribute's name; an empty one ends the header
        const std::size_t start = at;
        skipText();  // its type
        if (bytes.size() - at < 4 || littleEndian32(bytes, at) > bytes.size() - at - 4)
            throw ExrProblem(fmt::format("its attribute at byte {} reaches past its end", start));
        at += 4 + littleEndian32(bytes, at);
    }
}

struct Window {
    int left, top, width, height;
};

/// The data window, once it is sure that decoding it takes no more memory than it should.
Window checkedWindow(const Imf::Header& header, std::size_t fileSize) {
    const Imath::Box2i& box = header.dataWindow();
    const std::int64_t width = std::int64_t(box.max.x) - box.min.x + 1;
    const std::int64_t height = std::int64_t(box.max.y) - box.min.y + 1;
    if (width < 1 || height < 1) throw ExrProblem("its data window is empty");
    if (width > kMaxImageSide || height > kMaxImageSide)
        throw ExrProblem(fmt::format("{} x {} pixels are over the limit of {} a side", width,
                                     height, kMaxImageSide));

    std::uint64_t chunkWidth = std::uint64_t(width), chunkRows = kMaxChunkRows, channels = 0;
    if (header.hasTileDescription()) {
        const Imf::TileDescription& tile = header.tileDescription();
        if (tile.xSize < 1 || tile.ySize < 1) throw ExrProblem("its tiles are empty");
        chunkWidth = std::max<std::uint64_t>(chunkWidth, tile.xSize);
        chunkRows = tile.ySize;
        const std::uint64_t across = (std::uint64_t(width) + tile.xSize - 1) / tile.xSize;
        const std::uint64_t down = (std::uint64_t(height) + tile.ySize - 1) / tile.ySize;
        if (across * down > fileSize / 8)  // 8 bytes in the table of offsets for each
            throw ExrProblem(
                fmt::format("{} bytes cannot hold its {} tiles", fileSize, across * down));
    }
    for (auto channel = header.channels().begin(); channel != header.channels().end(); ++channel)
        ++channels;
    if (chunkRows > kMaxChunkBytes / (chunkWidth * 4 * std::max<std::uint64_t>(channels, 1)))
        throw ExrProblem(
            fmt::format("its {} channels of {} pixels a row are too much", channels, width));
    return {box.min.x, box.min.y, int(width), int(height)};
}

/// Which channels are the red, green and blue of the picture.
std::vector<std::string> colorChannels(const Imf::ChannelList& channels) {
    std::vector<std::string> names;
    if (channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B"))
        names = {"R", "G", "B"};
    else if (channels.findChannel("Y"))
        names = {"Y"};
    else
        throw ExrProblem("it has neither R, G and B nor Y channels");
    for (const std::string& name : names) {
        const Imf::Channel& channel = channels[name.c_str()];
        if (channel.xSampling != 1 || channel.ySampling != 1)
            throw ExrProblem(fmt::format("its {} channel is subsampled, which is not read", name));
    }
    return names;
}

std::uint8_t srgbCode(float linear) {
    if (!(linear > 0)) return 0;  // NaN too
    if (linear >= 1) return 255;
    const double value = linear;
    const double encoded =
        value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
    return std::uint8_t(std::lround(255 * encoded));
}

quality::RgbImage readPixels(Imf::InputFile& file, const Window& window,
                             const std::vector<std::string>& names) {
    const std::size_t width = std::size_t(window.width);
    std::vector<float> rows(names.size() * width * kRowsAtOnce);
    quality::RgbImage image;
    image.width = window.width;
    image.height = window.height;
    for (int done = 0; done < window.height; done += kRowsAtOnce) {
        const int count = std::min(kRowsAtOnce, window.height - done);
        const int top = window.top + done;
        Imf::FrameBuffer target;
        for (std::size_t i = 0; i < names.size(); ++i) {
            float* plane = rows.data() + i * width * kRowsAtOnce;
            target.insert(names[i],
                          Imf::Slice::Make(Imf::FLOAT, plane, Imath::V2i(window.left, top),
                                           window.width, count));
        }
        file.setFrameBuffer(target);
        file.readPixels(top, top + count - 1);
        // Grows with what was really decoded, not with what the header promised.
        for (std::size_t pixel = 0; pixel < width * std::size_t(count); ++pixel)
            for (std::size_t i = 0; i < 3; ++i)
                image.rgb.push_back(
                    srgbCode(rows[(names.size() == 3 ? i : 0) * width * kRowsAtOnce + pixel]));
    }
    return image;
}

/// OpenEXR's messages may quote the file: keep one line of plain characters.
std::string oneLine(const char* message) {
    std::string line;
    for (const char* c = message; *c != '\0' && line.size() < 200; ++c)
        line += *c >= ' ' && *c <= '~' ? *c : ' ';
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line;
}

}  // namespace

bool looksLikeExr(std::string_view bytes) {
    return bytes.size() >= 4 && littleEndian32(bytes, 0) == std::uint32_t(Imf::MAGIC);
}

Result<quality::RgbImage> decodeExr(std::string_view bytes, const std::string& name) {
    try {
        checkAttributes(bytes);
        MemoryStream stream(bytes, name);
        Imf::Header header;
        int version = 0;
        header.readFrom(stream, version);
        const Window window = checkedWindow(header, bytes.size());
        const std::vector<std::string> names = colorChannels(header.channels());
        stream.seekg(0);
        Imf::InputFile file(stream);
        return readPixels(file, window, names);
    } catch (const ExrProblem& problem) {
        return fail(fmt::format("{}: unusable EXR, {}; make the file anew", name, problem.what()));
    } catch (const std::exception& error) {
        return fail(
            fmt::format("{}: unusable EXR, {}; make the file anew", name, oneLine(error.what())));
    }
}

Result<void> writeExr(const std::filesystem::path& path, int width, int height,
                      const std::vector<ExrChannel>& channels) {
    if (width <= 0 || height <= 0) throw std::invalid_argument("width, height: must be over 0");
    if (channels.empty()) throw std::invalid_argument("channels: must not be empty");
    std::set<std::string> names;
    for (const ExrChannel& channel : channels) {
        if (channel.name.empty() || !names.insert(channel.name).second)
            throw std::invalid_argument("channels: each needs a name of its own");
        if (channel.values.size() != std::size_t(width) * height)
            throw std::invalid_argument("channels: each must hold width * height values");
    }
    try {
        Imf::Header header(width, height);
        header.compression() = Imf::ZIP_COMPRESSION;
        Imf::FrameBuffer source;
        for (const ExrChannel& channel : channels) {
            header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
            source.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, channel.values.data(),
                                                         Imath::V2i(0, 0), width, height));
        }
        Imf::StdOSStream stream;
        {
            Imf::OutputFile file(stream, header);
            file.setFrameBuffer(source);
            file.writePixels(height);
        }  // the destructor writes the table of offsets
        return writeWholeFile(path, stream.str());
    } catch (const std::exception& error) {
        return fail(
            fmt::format("{}: cannot be made an EXR: {}", path.string(), oneLine(error.what())));
    }
}

}  // namespace lodestar::app

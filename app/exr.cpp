// SPDX-License-Identifier: Apache-2.0
#include "exr.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/openexr.h>
#include <fmt/format.h>

#include "image_io.hpp"
#include "png.hpp"
#include "whole_file.hpp"

namespace lodestar::app {
namespace {

constexpr std::uint32_t kMagic = 20000630;
/// Caps on what a header may ask for: what one allocation of OpenEXR holds, and a tile's side.
constexpr std::size_t kMaxAllocation = std::size_t(1) << 30;
constexpr int kMaxTileSide = 4096;

/// What is wrong with the file.
struct ExrProblem : std::runtime_error {
    using std::runtime_error::runtime_error;
};

std::uint32_t littleEndian32(std::string_view bytes, std::size_t at) {
    const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(bytes[at + i])); };
    return byte(0) | byte(1) << 8 | byte(2) << 16 | byte(3) << 24;
}

/// OpenEXR's messages may quote the file: keep one line of plain characters.
std::string oneLine(const char* message) {
    std::string line;
    for (const char* c = message; *c != '\0' && line.size() < 200; ++c)
        line += *c >= ' ' && *c <= '~' ? *c : ' ';
    while (!line.empty() && (line.back() == ' ' || line.back() == '.')) line.pop_back();
    return line;
}

std::uint8_t srgbCode(float linear) {
    if (!(linear > 0)) return 0;  // NaN too
    if (linear >= 1) return 255;
    const float encoded =
        linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
    return std::uint8_t(255 * encoded + 0.5f);
}

/// An EXR file in memory, by OpenEXR's C interface: unlike the C++ one it checks every size against
/// the file, and that a chunk unpacks to as many bytes as it should.
class ExrReader {
public:
    explicit ExrReader(std::string_view content) : bytes(content) {
        exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
        setup.user_data = this;
        setup.error_handler_fn = keepMessage;
        setup.alloc_fn = allocate;
        setup.free_fn = std::free;
        setup.read_fn = read;
        setup.size_fn = size;
        setup.max_image_width = setup.max_image_height = kMaxImageSide;
        setup.max_tile_width = setup.max_tile_height = kMaxTileSide;
        setup.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
        check(exr_start_read(&context, "file", &setup));
    }
    ~ExrReader() { exr_finish(&context); }
    ExrReader(const ExrReader&) = delete;
    ExrReader& operator=(const ExrReader&) = delete;

    void check(exr_result_t result) const {
        if (result == EXR_ERR_SUCCESS) return;
        throw ExrProblem(message.empty() ? oneLine(exr_get_default_error_message(result))
                                         : message);
    }

    exr_context_t context = nullptr;

private:
    static ExrReader& self(exr_const_context_t context) {
        void* user = nullptr;
        exr_get_user_data(context, &user);
        return *static_cast<ExrReader*>(user);
    }
    static void keepMessage(exr_const_context_t context, exr_result_t, const char* text) {
        if (context != nullptr) self(context).message = oneLine(text);
    }
    static void* allocate(std::size_t size) {
        return size <= kMaxAllocation ? std::malloc(size) : nullptr;
    }
    static std::int64_t size(exr_const_context_t, void* user) {
        return std::int64_t(static_cast<ExrReader*>(user)->bytes.size());
    }
    static std::int64_t read(exr_const_context_t, void* user, void* to, std::uint64_t count,
                             std::uint64_t offset, exr_stream_error_func_ptr_t) {
        const std::string_view bytes = static_cast<ExrReader*>(user)->bytes;
        if (offset >= bytes.size()) return 0;
        count = std::min<std::uint64_t>(count, bytes.size() - offset);
        std::memcpy(to, bytes.data() + offset, count);
        return std::int64_t(count);
    }

    std::string_view bytes;
    std::string message;
};

/// Unpacks the chunks of the first part of a file into a picture.
class ExrDecoder {
public:
    explicit ExrDecoder(const ExrReader& source) : reader(source) {
        exr_storage_t storage;
        reader.check(exr_get_storage(reader.context, 0, &storage));
        if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
            throw ExrProblem("it has deep pixels, which are not read");
        exr_compression_t compression;
        reader.check(exr_get_compression(reader.context, 0, &compression));
        if (compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB)
            throw ExrProblem("its DWA compression is not read; save it with ZIP or PIZ");
        exr_attr_box2i_t window;
        reader.check(exr_get_data_window(reader.context, 0, &window));
        top = window.min.y;
        image.width = int(std::int64_t(window.max.x) - window.min.x + 1);
        image.height = int(std::int64_t(window.max.y) - window.min.y + 1);
        chooseChannels();
        if (storage == EXR_STORAGE_TILED)
            readTiles();
        else
            readScanlines();
    }

    quality::RgbImage image;

private:
    void chooseChannels() {
        const exr_attr_chlist_t* list = nullptr;
        reader.check(exr_get_channels(reader.context, 0, &list));
        const auto has = [&](std::string_view name) {
            for (int i = 0; i < list->num_channels; ++i) {
                const exr_attr_chlist_entry_t& channel = list->entries[i];
                if (channel.name.str != name) continue;
                if (channel.x_sampling != 1 || channel.y_sampling != 1)
                    throw ExrProblem(fmt::format("its {} is subsampled, which is not read", name));
                return true;
            }
            return false;
        };
        if (has("R") && has("G") && has("B"))
            channelNames = {"R", "G", "B"};
        else if (has("Y"))
            channelNames = {"Y"};
        else
            throw ExrProblem("it has neither R, G and B nor Y channels");
    }

    void readScanlines() {
        int rowsPerChunk = 0;
        reader.check(exr_get_scanlines_per_chunk(reader.context, 0, &rowsPerChunk));
        for (int row = 0; row < image.height; row += rowsPerChunk) {
            exr_chunk_info_t chunk;
            reader.check(exr_read_scanline_chunk_info(reader.context, 0, top + row, &chunk));
            place(chunk, 0, row);
        }
    }

    void readTiles() {
        std::int32_t tileWidth = 0, tileHeight = 0;
        reader.check(exr_get_tile_sizes(reader.context, 0, 0, 0, &tileWidth, &tileHeight));
        for (int row = 0; row < image.height; row += tileHeight)
            for (int column = 0; column < image.width; column += tileWidth) {
                exr_chunk_info_t chunk;
                reader.check(exr_read_tile_chunk_info(reader.context, 0, column / tileWidth,
                                                      row / tileHeight, 0, 0, &chunk));
                place(chunk, column, row);
            }
    }

    void place(const exr_chunk_info_t& chunk, int column, int row) {
        // What OpenEXR 3.1 leaves to its caller: it would hand out pixels that were never read.
        if (chunk.compression == EXR_COMPRESSION_NONE ? chunk.packed_size != chunk.unpacked_size
                                                      : chunk.packed_size > chunk.unpacked_size)
            throw ExrProblem(fmt::format("its chunk at byte {} has {} bytes for {} of pixels",
                                         chunk.data_offset, chunk.packed_size,
                                         chunk.unpacked_size));
        const int width = std::min(chunk.width, image.width - column);
        const int height = std::min(chunk.height, image.height - row);
        decode(chunk);
        // Grows with what was really decoded, not with what the header promised.
        image.rgb.resize(
            std::max(image.rgb.size(), std::size_t(3) * image.width * (std::size_t(row) + height)));
        const std::size_t plane = std::size_t(chunk.width) * chunk.height;
        const std::size_t nextChannel = channelNames.size() == 3 ? plane : 0;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const float* from = pixels.data() + std::size_t(y) * chunk.width + x;
                for (int i = 0; i < 3; ++i)
                    image.at(column + x, row + y)[i] = srgbCode(from[i * nextChannel]);
            }
    }

    /// Fills `pixels` with the planes of the chosen channels.
    void decode(const exr_chunk_info_t& chunk) {
        const std::size_t plane = std::size_t(chunk.width) * chunk.height;
        pixels.resize(plane * channelNames.size());
        exr_decode_pipeline_t pipeline = {};
        const auto run = [&] {
            exr_result_t result = exr_decoding_initialize(reader.context, 0, &chunk, &pipeline);
            if (result != EXR_ERR_SUCCESS) return result;
            for (int i = 0; i < pipeline.channel_count; ++i) {
                exr_coding_channel_info_t& channel = pipeline.channels[i];
                const auto at =
                    std::find(channelNames.begin(), channelNames.end(), channel.channel_name);
                if (at == channelNames.end()) continue;
                float* to = pixels.data() + plane * std::size_t(at - channelNames.begin());
                channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(to);
                channel.user_data_type = EXR_PIXEL_FLOAT;
                channel.user_bytes_per_element = sizeof(float);
                channel.user_pixel_stride = sizeof(float);
                channel.user_line_stride = std::int32_t(sizeof(float)) * chunk.width;
            }
            result = exr_decoding_choose_default_routines(reader.context, 0, &pipeline);
            if (result != EXR_ERR_SUCCESS) return result;
            return exr_decoding_run(reader.context, 0, &pipeline);
        };
        const exr_result_t result = run();
        exr_decoding_destroy(reader.context, &pipeline);
        reader.check(result);
    }

    const ExrReader& reader;
    int top = 0;
    std::vector<std::string_view> channelNames;  ///< R, G, B or Y
    std::vector<float> pixels;
};

}  // namespace

bool looksLikeExr(std::string_view bytes) {
    return bytes.size() >= 4 && littleEndian32(bytes, 0) == kMagic;
}

Result<quality::RgbImage> decodeExr(std::string_view bytes, const std::string& name) {
    try {
        const ExrReader reader(bytes);
        return std::move(ExrDecoder(reader).image);
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

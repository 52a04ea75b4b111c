// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstring>
#include <optional>

#include <lodestar/visibility/stream.hpp>

/// What the encoder and the decoder of .lvis must do alike.
namespace lodestar::visibility::stream_code {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

inline constexpr char kMagic[4] = {'L', 'V', 'I', 'S'};
inline constexpr std::size_t kMaxName = 1023;
inline constexpr std::uint32_t kMostClusters = 1u << 24;

/// The start of a file; the scene's name and the zstd frame follow.
struct Header {
    char magic[4];
    std::uint32_t version;
    std::uint64_t checksum;  // xxHash64 of everything after this field
    std::uint64_t sceneHash, clusterHash;
    std::uint32_t width, height, side;
    std::uint32_t nodes;
    float eye[3], at[3], up[3];
    float verticalFov, nearPlane, aspect, seconds;
    std::uint32_t predictIds;
    std::uint32_t nameBytes;
    std::uint32_t reserved;  // 0
    std::uint64_t rawBytes;  // of the frame's contents
    std::uint64_t frameBytes;
};
static_assert(sizeof(Header) == 128);
inline constexpr std::size_t kChecksummedFrom = 16;

/// The columns of the contents, in order; each starts with its length.
enum Column { clusters, headCodes, headDeltas, counts, nodeCodes, nodeDeltas, masks, kColumns };

// A head's code: which neighbour shows the same, and whether there is a list.
inline constexpr std::uint8_t kSameAs = 4;  // fewer: left, above, above right, above left
inline constexpr std::uint8_t kOther = 4;   // the difference to the left is in headDeltas
inline constexpr std::uint8_t kMixed = 8;
// A node's code: which candidate, or:
inline constexpr std::uint8_t kEscape = 255;  // the difference to the head is in nodeDeltas

/// The pixels before this one whose representative its own is likely to be.
inline std::array<std::uint32_t, kSameAs> earlier(const std::vector<Head>& heads, std::size_t width,
                                                  std::size_t pixel) {
    const std::size_t x = pixel % width;
    const bool top = pixel < width, left = x == 0, right = x + 1 == width;
    return {left ? 0 : heads[pixel - 1].id, top ? 0 : heads[pixel - width].id,
            top || right ? 0 : heads[pixel - width + 1].id,
            top || left ? 0 : heads[pixel - width - 1].id};
}

/// Ids that a pixel's list is likely to hold: what the pixels around it show, and the lists of
/// those before it. Without repetition, without the pixel's own representative.
class Candidates {
public:
    Candidates(const Record& record, std::size_t pixel) : own(record.heads[pixel].id) {
        const std::size_t width = record.width, x = pixel % width, y = pixel / width;
        const bool top = y == 0, bottom = y + 1 == record.height, left = x == 0,
                   right = x + 1 == width;
        const auto head = [&](bool outside, std::size_t at) {
            if (!outside) add(record.heads[at].id);
        };
        head(left, pixel - 1);
        head(top, pixel - width);
        head(right, pixel + 1);
        head(bottom, pixel + width);
        head(top || left, pixel - width - 1);
        head(top || right, pixel - width + 1);
        head(bottom || left, pixel + width - 1);
        head(bottom || right, pixel + width + 1);
        if (!left) addList(record, pixel - 1);
        if (!top) addList(record, pixel - width);
    }
    std::optional<std::uint32_t> at(std::size_t index) const {
        if (index >= count) return std::nullopt;
        return ids[index];
    }
    /// Its place, and out of the list: a pixel lists an id once.
    std::optional<std::uint8_t> take(std::uint32_t id) {
        for (std::size_t i = 0; i < count; ++i)
            if (ids[i] == id) {
                remove(i);
                return static_cast<std::uint8_t>(i);
            }
        return std::nullopt;
    }
    void remove(std::size_t index) {
        for (std::size_t i = index + 1; i < count; ++i) ids[i - 1] = ids[i];
        --count;
    }

private:
    static constexpr std::size_t kMost = 40;

    void add(std::uint32_t id) {
        if (id == own || count == kMost) return;
        for (std::size_t i = 0; i < count; ++i)
            if (ids[i] == id) return;
        ids[count++] = id;
    }
    void addList(const Record& record, std::size_t pixel) {
        for (const auto& node : listOf(record, pixel)) add(idOf(node));
    }

    std::uint32_t own;
    std::array<std::uint32_t, kMost> ids{};
    std::size_t count = 0;
};

inline std::uint64_t zigzag(std::int64_t v) {
    return (static_cast<std::uint64_t>(v) << 1) ^ static_cast<std::uint64_t>(v >> 63);
}
inline std::int64_t unzigzag(std::uint64_t v) {
    return static_cast<std::int64_t>(v >> 1) ^ -static_cast<std::int64_t>(v & 1);
}

/// Row `y` of a mask.
inline std::uint8_t rowOf(std::uint64_t mask, std::uint32_t side, std::uint32_t y) {
    return static_cast<std::uint8_t>(mask >> (y * side) & ((1u << side) - 1));
}

}  // namespace lodestar::visibility::stream_code

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestar/visibility/record_params.h>

/// The compact visibility record in memory, without Vulkan and with its lists unpacked: for
/// streams, tests and tools. record_params.h says how the device holds it.
namespace lodestar::visibility {

inline constexpr std::uint32_t kNoList = 0xffffffffu;

/// Of a pixel of grid B.
struct Head {
    std::uint32_t id = 0;          ///< the representative: most samples; of equals the smaller id
    std::uint32_t list = kNoList;  ///< first node; kNoList where all samples show `id`
};

/// A further triangle (or the background, 0) of a pixel. Nodes of a pixel stand together, by their
/// first samples. The representative has what their masks leave.
struct Node {
    std::uint32_t id = 0;                     ///< with shared::LS_LAST_NODE
    std::uint32_t maskLow = 0, maskHigh = 0;  ///< samples 0 … 31 and 32 … 63
};

struct Record {
    std::uint32_t width = 0, height = 0;  ///< grid B
    std::uint32_t side = 1;               ///< s: a pixel has s × s samples
    std::vector<Head> heads;
    std::vector<Node> nodes;

    std::uint32_t samples() const { return side * side; }
    /// All samples of a pixel.
    std::uint64_t fullMask() const { return ~std::uint64_t{0} >> (64 - samples()); }
};

inline bool hasList(const Head& head) {
    return head.list != kNoList;
}
inline std::uint64_t maskOf(const Node& node) {
    return node.maskLow | std::uint64_t{node.maskHigh} << 32;
}
inline std::uint32_t idOf(const Node& node) {
    return node.id & ~shared::LS_LAST_NODE;
}
inline bool isLast(const Node& node) {
    return (node.id & shared::LS_LAST_NODE) != 0;
}

/// The record as the device holds it.
struct PackedRecord {
    std::vector<std::uint32_t> heads, lists;
};
PackedRecord pack(const Record&);
/// The other way. Throws std::invalid_argument for words that are no record.
Record unpack(const PackedRecord&, std::uint32_t width, std::uint32_t height, std::uint32_t side);

/// The nodes of a pixel; empty where it has no list.
std::span<const Node> listOf(const Record&, std::size_t pixel);

/// What compact.comp computes, said plainly: from the ids of grid C (s·width a row).
/// Throws std::invalid_argument when their number does not fit.
Record compactReference(std::span<const std::uint32_t> ids, std::uint32_t width,
                        std::uint32_t height, std::uint32_t side);

/// The ids of grid C again.
std::vector<std::uint32_t> expandReference(const Record&);

/// Bytes of the record on the device, and of the thesis's layout for the same frame: an 8-byte head
/// a pixel and a 16-byte node for every id of a pixel that has several.
struct RecordBytes {
    std::uint64_t heads = 0, lists = 0;
    std::uint64_t thesisHeads = 0, thesisNodes = 0;
    std::uint64_t mixedPixels = 0;
    std::uint64_t total() const { return heads + lists; }
    std::uint64_t thesisTotal() const { return thesisHeads + thesisNodes; }
};
RecordBytes bytesOf(const Record&);

}  // namespace lodestar::visibility

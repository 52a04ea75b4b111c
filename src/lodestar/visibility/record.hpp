// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestar/visibility/record_params.h>

/// The compact visibility record in memory, without Vulkan: for streams, tests and tools.
namespace lodestar::visibility {

struct Record {
    std::uint32_t width = 0, height = 0;  ///< grid B
    std::uint32_t side = 1;               ///< s: a pixel has s × s samples
    std::vector<shared::VisibilityHead> heads;
    std::vector<shared::VisibilityNode> nodes;

    std::uint32_t samples() const { return side * side; }
    /// All samples of a pixel.
    std::uint64_t fullMask() const { return ~std::uint64_t{0} >> (64 - samples()); }
};

inline bool hasList(const shared::VisibilityHead& head) {
    return head.list < shared::LS_LIST_EMPTY;
}
inline std::uint64_t maskOf(const shared::VisibilityNode& node) {
    return node.maskLow | std::uint64_t{node.maskHigh} << 32;
}
inline std::uint32_t idOf(const shared::VisibilityNode& node) {
    return node.id & ~shared::LS_LAST_NODE;
}
inline bool isLast(const shared::VisibilityNode& node) {
    return (node.id & shared::LS_LAST_NODE) != 0;
}

/// The nodes of a pixel; empty where it has no list.
std::span<const shared::VisibilityNode> listOf(const Record&, std::size_t pixel);

/// What compact.comp computes, said plainly: from the ids of grid C (s·width a row).
/// Throws std::invalid_argument when their number does not fit.
Record compactReference(std::span<const std::uint32_t> ids, std::uint32_t width,
                        std::uint32_t height, std::uint32_t side);

/// The ids of grid C again.
std::vector<std::uint32_t> expandReference(const Record&);

/// Bytes of the record, and of the thesis's layout for the same frame: an 8-byte head a pixel and
/// a 16-byte node for every id of a pixel that has several.
struct RecordBytes {
    std::uint64_t heads = 0, nodes = 0;
    std::uint64_t thesisHeads = 0, thesisNodes = 0;
    std::uint64_t mixedPixels = 0;
    std::uint64_t total() const { return heads + nodes; }
    std::uint64_t thesisTotal() const { return thesisHeads + thesisNodes; }
};
RecordBytes bytesOf(const Record&);

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/record.hpp>

#include <bit>
#include <stdexcept>

namespace lodestar::visibility {

std::span<const Node> listOf(const Record& record, std::size_t pixel) {
    const Head& head = record.heads[pixel];
    if (!hasList(head)) return {};
    std::size_t end = head.list;
    while (!isLast(record.nodes[end])) ++end;
    return std::span(record.nodes).subspan(head.list, end + 1 - head.list);
}

Record compactReference(std::span<const std::uint32_t> ids, std::uint32_t width,
                        std::uint32_t height, std::uint32_t side) {
    if (ids.size() != std::size_t{width} * height * side * side)
        throw std::invalid_argument("compactReference: ids is not s·width × s·height");
    Record record{.width = width, .height = height, .side = side};
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < width; ++x) {
            std::vector<Node> found;  // in order of their first samples
            for (std::uint32_t i = 0; i < side * side; ++i) {
                const std::uint32_t id =
                    ids[(y * side + i / side) * width * side + x * side + i % side];
                std::size_t at = 0;
                while (at < found.size() && found[at].id != id) ++at;
                if (at == found.size()) found.push_back({id, 0, 0});
                (i < 32 ? found[at].maskLow : found[at].maskHigh) |= 1u << (i % 32);
            }
            std::size_t best = 0;
            for (std::size_t k = 1; k < found.size(); ++k) {
                const int ours = std::popcount(maskOf(found[k]));
                const int most = std::popcount(maskOf(found[best]));
                if (ours > most || (ours == most && found[k].id < found[best].id)) best = k;
            }
            const std::uint32_t id = found[best].id;
            if (found.size() == 1) {
                record.heads.push_back({id, kNoList});
                continue;
            }
            record.heads.push_back({id, static_cast<std::uint32_t>(record.nodes.size())});
            for (std::size_t k = 0; k < found.size(); ++k)
                if (k != best) record.nodes.push_back(found[k]);
            record.nodes.back().id |= shared::LS_LAST_NODE;
        }
    return record;
}

std::vector<std::uint32_t> expandReference(const Record& record) {
    const std::size_t side = record.side, row = record.width * side;
    std::vector<std::uint32_t> ids(row * record.height * side);
    for (std::size_t pixel = 0; pixel < record.heads.size(); ++pixel) {
        const std::size_t corner = pixel / record.width * side * row + pixel % record.width * side;
        for (std::size_t i = 0; i < record.samples(); ++i) {
            std::uint32_t id = record.heads[pixel].id;
            for (const Node& node : listOf(record, pixel))
                if (maskOf(node) >> i & 1) id = idOf(node);
            ids[corner + i / side * row + i % side] = id;
        }
    }
    return ids;
}

PackedRecord pack(const Record& record) {
    PackedRecord packed;
    for (std::size_t pixel = 0; pixel < record.heads.size(); ++pixel) {
        const Head& head = record.heads[pixel];
        if (!hasList(head)) {
            packed.heads.push_back(head.id);
            continue;
        }
        packed.heads.push_back(shared::LS_HEAD_LIST |
                               static_cast<std::uint32_t>(packed.lists.size()));
        packed.lists.push_back(head.id);
        for (const Node& node : listOf(record, pixel)) {
            packed.lists.insert(packed.lists.end(), {node.id, node.maskLow});
            if (record.side == 8) packed.lists.push_back(node.maskHigh);
        }
    }
    return packed;
}

Record unpack(const PackedRecord& packed, std::uint32_t width, std::uint32_t height,
              std::uint32_t side) {
    Record record{.width = width, .height = height, .side = side};
    const std::size_t nodeWords = side == 8 ? 3 : 2;
    const auto& lists = packed.lists;
    for (const std::uint32_t word : packed.heads) {
        if ((word & shared::LS_HEAD_LIST) == 0) {
            record.heads.push_back({word, kNoList});
            continue;
        }
        std::size_t at = word & ~shared::LS_HEAD_LIST;
        const auto first = static_cast<std::uint32_t>(record.nodes.size());
        if (at >= lists.size()) throw std::invalid_argument("unpack: a list past the end");
        record.heads.push_back({lists[at++], first});
        for (bool last = false; !last; at += nodeWords) {
            if (at + nodeWords > lists.size())
                throw std::invalid_argument("unpack: a list that does not end");
            record.nodes.push_back({lists[at], lists[at + 1], side == 8 ? lists[at + 2] : 0});
            last = isLast(record.nodes.back());
        }
    }
    return record;
}

RecordBytes bytesOf(const Record& record) {
    RecordBytes bytes{.heads = record.heads.size() * 4, .thesisHeads = record.heads.size() * 8};
    for (const Head& head : record.heads) bytes.mixedPixels += hasList(head);
    const std::uint64_t nodeBytes = record.side == 8 ? 12 : 8;
    bytes.lists = 4 * bytes.mixedPixels + nodeBytes * record.nodes.size();
    bytes.thesisNodes = 16 * (record.nodes.size() + bytes.mixedPixels);
    return bytes;
}

}  // namespace lodestar::visibility

// SPDX-License-Identifier: Apache-2.0
#include <lodestar/visibility/record.hpp>

#include <array>
#include <bit>
#include <stdexcept>

namespace lodestar::visibility {
namespace {

/// ⌈log₂ ids⌉: the planes of a list of two or more.
std::uint32_t planesOf(std::uint32_t ids) {
    return static_cast<std::uint32_t>(std::bit_width(ids - 1));
}

}  // namespace

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
        const std::span<const Node> list = listOf(record, pixel);
        for (const Node& node : list) packed.lists.push_back(node.id);
        const auto count = static_cast<std::uint32_t>(list.size() + 1);
        for (std::uint32_t plane = 0; plane < planesOf(count); ++plane) {
            std::uint64_t mask = 0;
            for (std::uint32_t k = 1; k < count; ++k)
                if (k >> plane & 1) mask |= maskOf(list[k - 1]);
            packed.lists.push_back(static_cast<std::uint32_t>(mask));
            if (record.side == 8) packed.lists.push_back(static_cast<std::uint32_t>(mask >> 32));
        }
    }
    return packed;
}

Record unpack(const PackedRecord& packed, std::uint32_t width, std::uint32_t height,
              std::uint32_t side) {
    Record record{.width = width, .height = height, .side = side};
    const auto& lists = packed.lists;
    std::size_t at = 0;
    const auto next = [&] {
        if (at >= lists.size()) throw std::invalid_argument("unpack: a list past the end");
        return lists[at++];
    };
    for (const std::uint32_t word : packed.heads) {
        if ((word & shared::LS_HEAD_LIST) == 0) {
            record.heads.push_back({word, kNoList});
            continue;
        }
        at = word & ~shared::LS_HEAD_LIST;
        const std::size_t first = record.nodes.size();
        record.heads.push_back({next(), static_cast<std::uint32_t>(first)});
        do {
            record.nodes.push_back({next(), 0, 0});
            if (record.nodes.size() - first >= record.samples())
                throw std::invalid_argument("unpack: more ids than samples");
        } while (!isLast(record.nodes.back()));
        const auto count = static_cast<std::uint32_t>(record.nodes.size() - first + 1);
        std::array<std::uint64_t, 6> planes{};
        for (std::uint32_t i = 0; i < planesOf(count); ++i) {
            planes[i] = next();
            if (side == 8) planes[i] |= std::uint64_t{next()} << 32;
        }
        for (std::uint32_t sample = 0; sample < record.samples(); ++sample) {
            std::uint32_t k = 0;
            for (std::uint32_t i = 0; i < planes.size(); ++i) k |= (planes[i] >> sample & 1) << i;
            if (k >= count) throw std::invalid_argument("unpack: a sample of no id");
            if (k == 0) continue;
            Node& node = record.nodes[first + k - 1];
            (sample < 32 ? node.maskLow : node.maskHigh) |= 1u << (sample % 32);
        }
    }
    return record;
}

RecordBytes bytesOf(const Record& record) {
    RecordBytes bytes{.heads = record.heads.size() * 4, .thesisHeads = record.heads.size() * 8};
    const std::uint64_t maskBytes = record.side == 8 ? 8 : 4;
    for (std::size_t pixel = 0; pixel < record.heads.size(); ++pixel) {
        if (!hasList(record.heads[pixel])) continue;
        ++bytes.mixedPixels;
        const auto ids = static_cast<std::uint32_t>(listOf(record, pixel).size() + 1);
        bytes.lists += 4 * ids + maskBytes * planesOf(ids);
    }
    bytes.thesisNodes = 16 * (record.nodes.size() + bytes.mixedPixels);
    return bytes;
}

}  // namespace lodestar::visibility

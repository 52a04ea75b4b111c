// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <zstd.h>

#include <lodestar/visibility/stream_code.hpp>

namespace lodestar::visibility {
namespace {

using namespace stream_code;

constexpr std::uint32_t kTriangleBits = 7;
constexpr const char* kAgain = "capture it again";

/// A column's bytes, read from the front.
class Reader {
public:
    Reader() = default;
    explicit Reader(std::span<const std::uint8_t> b) : bytes(b) {}

    std::optional<std::uint8_t> byte() {
        if (at == bytes.size()) return std::nullopt;
        return bytes[at++];
    }
    std::optional<std::uint64_t> varint() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 63; shift += 7) {
            const auto next = byte();
            if (!next) return std::nullopt;
            value |= std::uint64_t{*next & 127u} << shift;
            if (*next < 128) return value;
        }
        return std::nullopt;
    }
    std::optional<Reader> take(std::uint64_t size) {
        if (size > bytes.size() - at) return std::nullopt;
        const auto part = bytes.subspan(at, static_cast<std::size_t>(size));
        at += part.size();
        return Reader(part);
    }
    bool done() const { return at == bytes.size(); }
    std::size_t left() const { return bytes.size() - at; }
    std::uint8_t operator[](std::size_t i) const { return bytes[i]; }

private:
    std::span<const std::uint8_t> bytes;
    std::size_t at = 0;
};

/// Decompresses at most `rawBytes`, in steps: a frame that lies about its size gets no memory for
/// what it does not hold.
std::optional<std::vector<std::uint8_t>> inflate(std::span<const std::byte> frame,
                                                 std::uint64_t rawBytes) {
    const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                       &ZSTD_freeDCtx);
    ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, 27);
    std::vector<std::uint8_t> raw;
    ZSTD_inBuffer in{frame.data(), frame.size(), 0};
    constexpr std::size_t kStep = 1 << 20;
    for (;;) {
        const std::size_t begin = raw.size();
        const std::size_t room =
            static_cast<std::size_t>(std::min<std::uint64_t>(rawBytes - begin, kStep));
        raw.resize(begin + room);
        ZSTD_outBuffer out{raw.data() + begin, room, 0};
        const std::size_t left = ZSTD_decompressStream(context.get(), &out, &in);
        raw.resize(begin + out.pos);
        if (ZSTD_isError(left)) return std::nullopt;
        if (left == 0) break;
        if (out.pos == 0) return std::nullopt;  // cut short, or longer than it says
    }
    if (raw.size() != rawBytes || in.pos != frame.size()) return std::nullopt;
    return raw;
}

/// The record from the columns, or what is wrong.
class Decoder {
public:
    Decoder(const Header& h, std::array<Reader, kColumns> c) : header(h), columns(c) {}

    std::optional<std::string> run() {
        record.width = header.width;
        record.height = header.height;
        record.side = header.side;
        for (const auto step : {&Decoder::readClusters, &Decoder::readHeads, &Decoder::readNodes,
                                &Decoder::readMasks, &Decoder::restoreIds})
            if (!(this->*step)()) return what;
        return std::nullopt;
    }
    Record record;

private:
    bool wrong(std::string text) {
        what = std::move(text);
        return false;
    }
    std::uint64_t pixels() const { return std::uint64_t{header.width} * header.height; }
    bool known(std::int64_t id) const {
        return id == 0 || (id >= (1 << kTriangleBits) &&
                           static_cast<std::uint64_t>(id >> kTriangleBits) <= used.size());
    }

    bool readClusters() {
        std::uint64_t cluster = 0;
        while (!columns[clusters].done()) {
            const auto step = columns[clusters].varint();
            if (!step || *step == 0 || *step >= kMostClusters ||
                (cluster += *step) >= kMostClusters)
                return wrong("cluster table: entries out of order");
            used.push_back(static_cast<std::uint32_t>(cluster));
        }
        return true;
    }

    bool readHeads() {
        if (columns[headCodes].left() != pixels())
            return wrong(fmt::format("{} pixels coded, {} in the picture",
                                     columns[headCodes].left(), pixels()));
        record.heads.reserve(static_cast<std::size_t>(pixels()));
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            const std::uint8_t code = *columns[headCodes].byte();
            const std::uint8_t which = code & ~kMixed;
            const auto before = earlier(record.heads, record.width, pixel);
            std::int64_t id = 0;
            if (which < kSameAs) {
                id = before[which];
            } else {
                const auto delta = which == kOther ? columns[headDeltas].varint() : std::nullopt;
                if (!delta) return wrong(fmt::format("pixel {}: no id", pixel));
                id = header.predictIds ? before[0] + unzigzag(*delta)
                                       : static_cast<std::int64_t>(std::min<std::uint64_t>(
                                             *delta, 0x7fffffffffffffffull));
            }
            if (!known(id)) return wrong(fmt::format("pixel {}: an id of no cluster", pixel));
            const bool mixed = (code & kMixed) != 0;
            const std::uint32_t list = mixed ? 0 : kNoList;
            record.heads.push_back({static_cast<std::uint32_t>(id), list});
            mixedPixels.resize(mixedPixels.size() + mixed, pixel);
        }
        return columns[headDeltas].done() || wrong("ids of no pixel");
    }

    bool readNodes() {
        // What decoding reads of a pixel not yet reached must not look like a list.
        for (const std::size_t pixel : mixedPixels) record.heads[pixel].list = kNoList;
        for (const std::size_t pixel : mixedPixels) {
            const auto count = columns[counts].byte();
            if (!count || *count + 1u >= record.samples())
                return wrong(fmt::format("pixel {}: a list without a length it can have", pixel));
            const auto first = static_cast<std::uint32_t>(record.nodes.size());
            Candidates candidates(record, pixel);
            for (unsigned i = 0; i <= *count; ++i) {
                const auto id = nodeId(candidates, record.heads[pixel].id);
                if (!id) return wrong(fmt::format("pixel {}: an id of no cluster", pixel));
                for (std::size_t k = first; k < record.nodes.size(); ++k)
                    if (record.nodes[k].id == *id)
                        return wrong(fmt::format("pixel {}: an id listed twice", pixel));
                if (*id == record.heads[pixel].id)
                    return wrong(fmt::format("pixel {}: its representative listed", pixel));
                record.nodes.push_back({*id, 0, 0});
            }
            record.nodes.back().id |= shared::LS_LAST_NODE;
            record.heads[pixel].list = first;
        }
        if (record.nodes.size() != header.nodes || !columns[counts].done() ||
            !columns[nodeCodes].done() || !columns[nodeDeltas].done())
            return wrong("lists of no pixel");
        return true;
    }

    std::optional<std::uint32_t> nodeId(Candidates& candidates, std::uint32_t head) {
        const auto code = columns[nodeCodes].byte();
        if (!code) return std::nullopt;
        if (*code != kEscape) {
            if (!header.predictIds) return std::nullopt;
            const auto id = candidates.at(*code);
            if (id) candidates.remove(*code);
            return id;
        }
        const auto delta = columns[nodeDeltas].varint();
        if (!delta) return std::nullopt;
        const std::int64_t id = (header.predictIds ? std::int64_t{head} : 0) + unzigzag(*delta);
        if (!known(id)) return std::nullopt;
        return static_cast<std::uint32_t>(id);
    }

    bool readMasks() {
        const std::size_t count = record.nodes.size();
        if (columns[masks].left() != count * record.side) return wrong("masks of no node");
        for (std::size_t pixel : mixedPixels) {
            std::uint64_t taken = 0;
            for (std::size_t i = record.heads[pixel].list;; ++i) {
                std::uint64_t mask = 0;
                std::uint8_t row = 0;
                for (std::uint32_t y = 0; y < record.side; ++y) {
                    row ^= columns[masks][y * count + i];
                    if (row >> record.side) return wrong(fmt::format("pixel {}: a mask", pixel));
                    mask |= std::uint64_t{row} << (y * record.side);
                }
                if (mask == 0 || (mask & taken) != 0)
                    return wrong(fmt::format("pixel {}: masks that are empty or overlap", pixel));
                taken |= mask;
                record.nodes[i].maskLow = static_cast<std::uint32_t>(mask);
                record.nodes[i].maskHigh = static_cast<std::uint32_t>(mask >> 32);
                if (isLast(record.nodes[i])) break;
            }
            if (taken == record.fullMask())
                return wrong(fmt::format("pixel {}: nothing left for the first id", pixel));
        }
        return true;
    }

    bool restoreIds() {
        const auto restored = [&](std::uint32_t id) {
            return id == 0 ? 0
                           : used[(id >> kTriangleBits) - 1] << kTriangleBits |
                                 (id & ((1u << kTriangleBits) - 1));
        };
        for (auto& head : record.heads) head.id = restored(head.id);
        for (auto& node : record.nodes)
            node.id = restored(idOf(node)) | (node.id & shared::LS_LAST_NODE);
        return true;
    }

    Header header;
    std::array<Reader, kColumns> columns;
    std::vector<std::uint32_t> used;
    std::vector<std::size_t> mixedPixels;
    std::string what;
};

/// What is wrong with a header whose magic and version are right; empty: nothing.
std::string headerFault(const Header& h, std::size_t fileBytes, const DecodeOptions& options) {
    if (h.side != 1 && h.side != 2 && h.side != 4 && h.side != 8)
        return fmt::format("byte 40: {} samples a side; there are 1, 2, 4 and 8", h.side);
    if (h.width < 1 || h.height < 1 || h.width > 16384 / h.side || h.height > 16384 / h.side)
        return fmt::format("byte 32: {}x{} pixels of {} samples a side are too many", h.width,
                           h.height, h.side);
    const std::uint64_t pixels = std::uint64_t{h.width} * h.height;
    if (h.nodes > pixels * (h.side * h.side - 1))
        return fmt::format("byte 44: {} list entries are more than its pixels can have", h.nodes);
    // The longest that columns can be: varints of five bytes, a mask row a byte.
    const std::uint64_t most = 128 + 5ull * kMostClusters + 7 * pixels + (7ull + h.side) * h.nodes;
    if (h.rawBytes > most) return fmt::format("byte 112: {} bytes are too many", h.rawBytes);
    if (pixels * 16 + h.nodes * 12ull + h.rawBytes > options.maxBytes)
        return fmt::format("byte 32: {}x{} pixels are more than fit in memory", h.width, h.height);
    if (h.reserved != 0) return "byte 108: something in the place kept free";
    if (h.nameBytes > kMaxName) return "byte 104: a scene name of over 1023 bytes";
    const std::uint64_t rest = fileBytes - sizeof h;
    if (h.nameBytes > rest || h.frameBytes != rest - h.nameBytes)
        return fmt::format("byte 120: {} bytes follow, the header says {} and {}", rest,
                           h.nameBytes, h.frameBytes);
    for (const float f : {h.eye[0], h.eye[1], h.eye[2], h.at[0], h.at[1], h.at[2], h.up[0], h.up[1],
                          h.up[2], h.seconds})
        if (!std::isfinite(f)) return "byte 48: a camera that is not finite";
    if (!(h.verticalFov > 0 && h.verticalFov < 3.15f && h.nearPlane > 0 && h.nearPlane < 1e30f &&
          h.aspect > 0 && h.aspect < 1e6f))
        return "byte 84: a camera without a view";
    if (h.predictIds > 1) return "byte 100: an unknown way of coding ids";
    return "";
}

}  // namespace

Result<Stream> decodeStream(std::span<const std::byte> bytes, const std::string& name,
                            const DecodeOptions& options) {
    const auto refuse = [&](const std::string& what, const char* toDo = kAgain) {
        return fail(fmt::format("{}: {}; {}", name, what, toDo));
    };
    Header h{};
    if (bytes.size() < 8 || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0)
        return refuse("byte 0: not a .lvis stream", "make one with `lodestar capture`");
    std::memcpy(&h, bytes.data(), std::min(bytes.size(), sizeof h));
    if (h.version != kStreamVersion)
        return refuse(fmt::format("byte 4: version {} of the format, this program reads {}",
                                  h.version, kStreamVersion));
    if (bytes.size() < sizeof h)
        return refuse(fmt::format("byte {}: ends within its header", bytes.size()));
    if (const std::string fault = headerFault(h, bytes.size(), options); !fault.empty())
        return refuse(fault);
    if (options.checksum && hashOf(bytes.subspan(kChecksummedFrom)) != h.checksum)
        return refuse("byte 8: the checksum does not match: the file was damaged", "copy it again");

    const auto raw = inflate(bytes.subspan(sizeof h + h.nameBytes), h.rawBytes);
    if (!raw)
        return refuse(fmt::format("byte {}: damaged compressed data", sizeof h + h.nameBytes));
    std::array<Reader, kColumns> columns;
    Reader all(*raw);
    for (Reader& column : columns) {
        const auto size = all.varint();
        const auto part = size ? all.take(*size) : std::nullopt;
        if (!part) return refuse("contents: a column that does not fit");
        column = *part;
    }
    if (!all.done()) return refuse("contents: bytes of no column");
    Decoder decoder(h, columns);
    if (const auto fault = decoder.run()) return refuse("contents: " + *fault);

    Stream stream;
    stream.record = std::move(decoder.record);
    stream.camera = {.eye = {h.eye[0], h.eye[1], h.eye[2]},
                     .at = {h.at[0], h.at[1], h.at[2]},
                     .up = {h.up[0], h.up[1], h.up[2]},
                     .verticalFov = h.verticalFov,
                     .nearPlane = h.nearPlane};
    stream.aspect = h.aspect;
    stream.seconds = h.seconds;
    stream.scene.assign(reinterpret_cast<const char*>(bytes.data()) + sizeof h, h.nameBytes);
    stream.sceneHash = h.sceneHash;
    stream.clusterHash = h.clusterHash;
    return stream;
}

}  // namespace lodestar::visibility
